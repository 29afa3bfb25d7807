import numpy as np

from segcore.learned.squeezing import squeeze


def test_squeezed_numbers_are_their_signed_logarithms():
    rng = np.random.default_rng(0)
    numbers = np.concatenate(
        [rng.normal(size=1000) * 10.0 ** rng.uniform(-20, 15, 1000), [0.0, 1.0, -1.0, 1e300, 2**0.5 - 1, 1e-300]]
    )
    row = numbers.copy()
    squeeze(row, np.empty((2, len(row))))
    np.testing.assert_allclose(row, np.sign(numbers) * np.log1p(np.abs(numbers)), rtol=1e-15, atol=1e-15)
