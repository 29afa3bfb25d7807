"""How many clicks a person needs until a part is right: simulated people, evaluation and training."""
