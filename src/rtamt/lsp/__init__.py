"""The language server of ``rtamt lsp``: what editors show and change while a specification is written.

``pip install 'rtamt[lsp]'``: pygls, which only three modules need. The modules:

==========  =====================================================================
module      purpose
==========  =====================================================================
places      positions of editors, and offsets
symbols     declared names, and where they are used
tokens      a position in the tokens of a text
uses        the symbol of each name that declares nothing
outline     the names of a text, also of a wrong one
document    one version of a text, parsed once
imported    names that other files define
problems    errors and findings, and what mends them
hover       what is known about the word under the pointer
completion  completions at a position
rename      another name, without a change of meaning
meaning     what a text means, to compare two texts
colors      semantic tokens
lenses      the verdicts above requirements
evaluation  the process that reads recordings
recording   the server's handle of that process: a request, a time limit
messages    answers to messages that are wrong, and reports of errors (pygls)
session     what the server keeps between requests (pygls)
server      the requests of the protocol (pygls)
==========  =====================================================================
"""
