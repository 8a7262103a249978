"""The executable definition of every operator; shares nothing with the compiler and the engine but the formula."""
