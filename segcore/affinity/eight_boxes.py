"""The entry of a ray into eight boxes at once, with vector instructions.

numba compiles a loop over eight boxes to scalar instructions, because it unrolls the loop before LLVM could make
vectors of it. The function is therefore given to LLVM as operations on vectors, which LLVM translates for any
processor.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

WIDTH = 8
_VECTOR = ir.VectorType(ir.FloatType(), WIDTH)
_NONE = ir.Constant(_VECTOR, ir.Undefined)
_FIRST = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)


@intrinsic
def enter_boxes(_context, groups, group, ray, nearest, entry):  # type: ignore[no-untyped-def]
    """Write the distances at which a ray enters eight boxes into ``entry``; bit k is set if it meets box k.

    Parameters
    ----------
    groups : (G, 6, 8) float32, for each group the least and then the largest coordinates of its boxes.
    group : int64, of the boxes.
    ray : the six numbers ox, oy, oz, 1 / dx, 1 / dy, 1 / dz, float32.
    nearest : float32; boxes that the ray enters beyond this distance are not met.
    entry : (8,) float32.
    """

    def generate(context, builder, signature, arguments):  # type: ignore[no-untyped-def]
        of_groups, number, numbers, limit, result = arguments
        boxes = context.make_array(signature.args[0])(context, builder, of_groups).data
        first = builder.mul(number, ir.Constant(number.type, 6 * WIDTH))
        low = ir.Constant(_VECTOR, [0.0] * WIDTH)
        high = _spread(builder, limit)
        for axis in range(3):
            origin, inverse = (_spread(builder, builder.extract_value(numbers, k)) for k in (axis, 3 + axis))
            a, b = (
                builder.fmul(builder.fsub(_row(builder, boxes, first, k), origin), inverse) for k in (axis, 3 + axis)
            )
            low = _chosen(builder, ">", low, _chosen(builder, "<", a, b))
            high = _chosen(builder, "<", high, _chosen(builder, ">", a, b))
        place = context.make_array(signature.args[4])(context, builder, result).data
        builder.store(low, builder.bitcast(place, _VECTOR.as_pointer()), align=4)
        return builder.bitcast(builder.fcmp_ordered("<=", low, high), ir.IntType(8))

    return types.uint8(groups, group, ray, nearest, entry), generate


def _row(builder: Any, boxes: Any, first: Any, row: int) -> Any:
    place = builder.gep(boxes, [builder.add(first, ir.Constant(first.type, row * WIDTH))])
    return builder.load(builder.bitcast(place, _VECTOR.as_pointer()), align=4)


def _spread(builder: Any, number: Any) -> Any:
    """A vector of equal numbers."""
    one = builder.insert_element(_NONE, number, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(one, _NONE, _FIRST)


def _chosen(builder: Any, relation: str, a: Any, b: Any) -> Any:
    """The smaller or the larger numbers of two vectors; those of the second if one is not a number."""
    return builder.select(builder.fcmp_ordered(relation, a, b), a, b)
