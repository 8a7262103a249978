"""The local web page of ``rtamt play``: requirements and signals, evaluated while they are edited.

``pip install 'rtamt[play]'``: starlette and uvicorn. Its modules:

===============  =====================================================================
module           purpose
===============  =====================================================================
messages         requests of the page, validated
vocabulary       the words that the page completes
drawn_signals    signals that the user draws, as samples
recordings       recordings that the user loads, by number
recent           the last result, which is looked at closer without computing it again
downsampling     long lines, reduced to the range of values in each pixel
evaluation       robustness, verdict and explanation of a request
online           what online monitors report while the samples arrive
witnesses        a witness or a counterexample, as signals to draw
request_handler  requests to answers, by the kind of the request
worker           the process that answers, so that a request can be ended
worker_pool      the workers as the server sees them: time limits, late requests
server           the application: the page, its token, uploads
page/            the page: one document, scripts, one style sheet
===============  =====================================================================
"""
