"""Plot signals, robustness and explanations, and draw formulas as trees.

``scene.py`` computes the content of a plot as data, without drawing. The HTML report shows the same scene.

=========  ===============================================================
module     purpose
=========  ===============================================================
scene      the content of a plot as data
band       bounds at the start of a trace, after each sample
panels     which signals share a panel
lines      points of lines, and intervals in which a formula does not hold
x_axis     the times of a recording as positions on the x axis
canvas     a figure of rows over the same time
figure     draw a scene with matplotlib
uncertain  draw bounds where samples are missing or uncertain
axes       matplotlib, and vertical axes with infinities
texts      names and formulas as there is room for them
saving     write a figure to a file
tree       draw a formula as a tree
style      colours and markers
=========  ===============================================================
"""
