"""The colours of all pictures. No result depends on them: see ``EXCLUDED_MODULES`` in ``study.run.fingerprint``."""

# Colours of Okabe and Ito, Color Universal Design (2008); their yellow is too light for lines.
BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
GREY, DARK = "#8C8C8C", "#4D4D4D"
