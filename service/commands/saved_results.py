"""What `cleave submit` can save of a file: the ending of its name, and the path below the job."""

RESULTS = {
    "seg": ("seg", "labels?format=seg"),
    "npy": ("npy", "labels?format=npy"),
    "json": ("json", "hierarchy"),
    "glb": ("glb", "model.glb"),
    "ply": ("ply", "model.ply"),
    "obj": ("obj", "model.obj"),
    "3mf": ("3mf", "model.3mf"),
    "zip": ("zip", "parts.zip"),
    "png": ("png", "preview.png"),
}
