"""Whatever holds a recording to a trace: ``reading.py`` is the face, ``formats.py`` THE LIST of file formats."""
