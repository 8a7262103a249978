"""How an error points at the text."""


def with_carets(text: str, marks: str, sentence: str) -> str:
    """What an error in a text of one line prints; ``marks`` is what stands under the text."""
    column = len(marks) - len(marks.lstrip()) + 1
    return f"{sentence}\n  line 1, column {column}:\n    {text}\n    {marks}"
