"""The kernel of a model as one native function: traced from its terms, written as C++, compiled once."""
