"""One module for each command of ``python -m bench``.

A command is a module with a docstring, whose first line is the summary in the list of commands, and two functions:
``add_arguments(parser)`` declares its arguments, ``run(arguments)`` does the work and prints. A command that cannot run
with its arguments raises ``BenchmarkError``.
"""
