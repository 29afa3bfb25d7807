import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from segcore.affinity.frames import tangent_frames


@given(npst.arrays(np.float64, (5, 3), elements=st.floats(-1, 1)))
def test_frames_are_orthonormal_and_right_handed(vectors):
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    axes = np.concatenate([vectors[length[:, 0] > 1e-3] / length[length > 1e-3, None], np.eye(3), -np.eye(3)])
    u, v = tangent_frames(axes)
    frame = np.stack([u, v, axes], axis=1)
    np.testing.assert_allclose(frame @ frame.transpose(0, 2, 1), np.tile(np.eye(3), (len(axes), 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(frame), 1.0)
