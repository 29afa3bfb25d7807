"""Shortcuts through numba, for a process that compiles kernels and calls none.

numba makes machine code of each function that a kernel calls, although all of them become part of the kernel, and finds
the types of equal calls again and again. The shortcuts spare more than a quarter of the time. They replace methods
within numba, so that they are taken only with the releases of numba that they are tested with.
"""

from typing import Any

import numba
from llvmlite.binding import ffi
from numba.core import ir
from numba.core.codegen import JITCodeLibrary, JITCPUCodegen
from numba.core.lowering import BaseLower
from numba.core.targetconfig import TargetConfig
from numba.core.types.functions import BaseFunction

_TESTED = ("0.68.",)


def take_shortcuts() -> bool:
    """Compile faster from now on in this process; return False if this release of numba is not known.

    Kernels that are compiled afterwards can be saved in the cache, and cannot be called in this process.
    """
    if not numba.__version__.startswith(_TESTED):
        return False
    _skip_machine_code_of_parts()
    _remember_types_of_calls()
    _skip_checks()
    return True


def _skip_machine_code_of_parts() -> None:
    """Make machine code of kernels that have an entry from Python alone, when they are saved.

    The functions that they call are inlined and linked, so that they need neither machine code nor the slow half of the
    optimisation, which each kernel passes as a whole.
    """
    optimize, load = JITCodeLibrary._optimize_final_module, JITCodeLibrary._finalize_final_module
    serialize = JITCodeLibrary.serialize_using_object_code

    def optimize_final_module(library: Any) -> None:
        if hasattr(library, "has_entry"):
            optimize(library)
            return
        codegen = library._codegen
        passes, builder = codegen._module_pass_manager(
            loop_vectorize=codegen._loopvect, slp_vectorize=False, opt=codegen._opt_level, cost="cheap"
        )
        passes.run(library._final_module, builder)

    def finalize_final_module(library: Any) -> None:
        library._finalize_dynamic_globals()
        library._verify_declare_only_symbols()
        library._finalized = True

    def get_pointer_to_function(library: Any, name: str) -> int:
        if any(function.name == name for function in library._final_module.functions):
            library.has_entry = True
        library._ensure_finalized()
        return 0

    def serialize_using_object_code(library: Any) -> Any:
        library._ensure_finalized()
        if not hasattr(library, "has_entry"):
            return library.serialize_using_bitcode()
        load(library)
        return serialize(library)

    JITCodeLibrary._optimize_final_module = optimize_final_module
    JITCodeLibrary._finalize_final_module = finalize_final_module
    JITCodeLibrary.get_pointer_to_function = get_pointer_to_function
    JITCodeLibrary.serialize_using_object_code = serialize_using_object_code
    JITCPUCodegen.set_env = lambda *_: None
    BaseLower.create_cfunc_wrapper = lambda _: None


def _remember_types_of_calls() -> None:
    """Find the signature for each combination of arguments of one of numba's own functions once."""
    find = BaseFunction.get_call_type

    def get_call_type(function: Any, context: Any, args: Any, kws: Any) -> Any:
        known = function.__dict__.setdefault("known_signatures", {})
        key = (args, tuple(kws.items()))
        if key not in known:
            known[key] = find(function, context, args, kws)
        return known[key]

    BaseFunction.get_call_type = get_call_type  # type: ignore[method-assign, assignment]


def _skip_checks() -> None:
    """Compare options as one dictionary, look at the few types that hold variables, and do not time calls of LLVM."""
    without_variables = {str, int, float, bool, type(None), ir.Loc, type(len)}
    look = ir.Inst._rec_list_vars

    def values(config: Any) -> dict[str, Any]:
        cls = type(config)
        if "defaults" not in cls.__dict__:
            cls.defaults = {name: option.default for name, option in cls.options.items()}
        return cls.defaults | config._values

    def list_variables(instruction: Any, value: Any) -> list[Any]:
        kind = type(value)
        if kind is ir.Var:
            return [value]
        if kind is not dict:
            return [] if kind in without_variables else look(instruction, value)
        found = []
        for item in value.values():
            if type(item) is ir.Var:
                found.append(item)
            elif type(item) not in without_variables:
                found.extend(list_variables(instruction, item))
        return found

    TargetConfig.values = values
    ir.Inst._rec_list_vars = list_variables
    ffi.lib._lock._cblist.clear()
