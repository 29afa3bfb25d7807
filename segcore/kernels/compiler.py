"""The process that compiles kernels: it reads their numbers from its standard input and writes them when they are done.

It ends with its input, in the middle of a kernel as well, so that it does not outlive the process that started it.
"""

import gc
import logging
import os
import signal
import sys
import threading
from queue import SimpleQueue
from typing import NoReturn

from segcore.kernels.manifest import kernels
from segcore.kernels.shortcuts import take_shortcuts

log = logging.getLogger("segcore")


def main() -> NoReturn:
    """Compile kernels; the argument is added to the niceness of the process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C at a terminal is for the process that started it
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    answers = os.dup(1)
    os.dup2(2, 1)
    os.nice(int(sys.argv[1]))
    gc.disable()  # it takes a sixth of the time, and the process ends soon
    take_shortcuts()
    orders: SimpleQueue[int] = SimpleQueue()
    threading.Thread(target=_read, args=[orders], daemon=True).start()
    while True:
        number = orders.get()
        kernel = kernels()[number]
        try:
            kernel.compile()
        except Exception as error:  # whoever calls it sees the same error
            log.warning("the kernel %s cannot be compiled ahead of its use: %s", kernel.place, error)
        os.write(answers, b"%d\n" % number)


def _read(orders: "SimpleQueue[int]") -> None:
    for line in sys.stdin.buffer:
        orders.put(int(line))
    os._exit(0)


if __name__ == "__main__":
    main()
