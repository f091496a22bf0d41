"""The local workbench: a model, its recordings and results, looked at in a browser.

What is shown is computed by pure functions from small frozen values (`bench`, `mapping`,
`simulated`, `lacking`, `results`); `figures` and `page` draw it with Bokeh, `serving` serves it on
the loopback address alone.
"""
