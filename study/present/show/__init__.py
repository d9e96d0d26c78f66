"""A case to look at, from one run: storyboard, animation, and files for ParaView."""

from study.present.show.showing import Shown, count_images, draw_show

__all__ = ["Shown", "count_images", "draw_show"]
