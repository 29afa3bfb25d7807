"""How far the compilation of kernels is for which waiting jobs wait, at the first start of an installation."""

from dataclasses import dataclass

from redis import Redis

KEY = "cleave:compilation"
_TTL_S = 60  # a worker publishes each kernel that is done, and the slowest takes some seconds


@dataclass(frozen=True, slots=True)
class Compilation:
    done: int
    count: int

    def __str__(self) -> str:
        return f"compiling, once: {self.done} of {self.count}"


def publish_compilation(connection: Redis, state: Compilation | None) -> None:
    """Tell how far it is; None at its end."""
    if state is None:
        connection.delete(KEY)
    else:
        connection.set(KEY, f"{state.done} {state.count}", ex=_TTL_S)


def compilation_from(value: bytes | None) -> Compilation | None:
    """Return the state that a value of the key stands for."""
    return None if value is None else Compilation(*map(int, value.split()))


def current_compilation(connection: Redis) -> Compilation | None:
    """Return how far it is; None if nothing is compiled.

    Raises
    ------
    QueueError
        If Redis does not answer.
    """
    value: bytes | None = connection.get(KEY)  # type: ignore[assignment]  # answers are not decoded
    return compilation_from(value)
