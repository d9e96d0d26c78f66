"""Exact solutions with details of many sizes. Each detail reaches into the body in proportion to its size."""

from manufactured.multiscale.fading import FadingFace
from manufactured.multiscale.roller import COARSEST_ROLLER, ROLLERS, rollers
from manufactured.multiscale.trains import StripFace, multiscale

__all__ = ["COARSEST_ROLLER", "ROLLERS", "FadingFace", "StripFace", "multiscale", "rollers"]
