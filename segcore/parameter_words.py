"""The parameters in a person's words, for forms: titles, choices, and which ones speak of algorithms."""

TITLES = {
    "preset": "Preset",
    "structure": "Follow the structure of the file",
    "graph": "Nodes of the graph",
    "affinity": "What borders follow",
    "thinning": "Thinning",
    "solver": "Algorithm of the cuts",
    "p": "Exponent",
    "starts": "Starts",
    "iterations": "Iterations",
    "order": "Which part is cut next",
    "max_segments": "Most parts",
    "clusters": "Clusters",
    "seed": "Seed",
}

# Of the parameters that need no knowledge of the method; a form shows the others to those who ask for them.
CHOICES: dict[str, dict[str, str]] = {
    "structure": {
        "none": "No: look at the shape alone",
        "shells": "Its shells: pieces that do not touch",
        "groups": "Its groups: objects and nodes",
        "materials": "Its materials",
    },
    "affinity": {
        "learned": "What people chose on many meshes",
        "concavity": "Creases, and the thickness of the body",
        "minima_rule": "Creases alone",
        "adjacency": "Nothing: borders are as short as possible",
    },
    "order": {
        "learned": "The one that people would cut",
        "ncut": "The one with the clearest border (normalized cut)",
        "ncc": "The one with the clearest border (Cheeger cut)",
        "volume": "The largest",
    },
    "max_segments": {},
}

ABOUT = {
    "structure": "If the file has pieces of its own, they can be the parts. Larger numbers of parts cut these pieces.",
    "affinity": "What decides where a border between two parts runs.",
    "order": "It decides which parts there are at small numbers of parts.",
    "max_segments": "The slider ends at this number of parts. If it is empty, it ends where no sensible cut is left.",
}


def words(name: str) -> dict[str, object]:
    """The title of a parameter, ``x-advanced``, and for a form its choices and a sentence.

    These are ``x-choices`` and ``x-about`` of a JSON Schema; the description there is for people who know the method.
    """
    choices = CHOICES.get(name)
    shown: dict[str, object] = {"title": TITLES[name], "x-advanced": choices is None}
    if choices:
        shown["x-choices"] = choices
    if name in ABOUT:
        shown["x-about"] = ABOUT[name]
    return shown
