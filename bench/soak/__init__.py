"""An installation whose processes are killed at random as it works: is anything lost, does anything come out wrong?"""
