"""Frames into an MP4 that plays everywhere: H.264, yuv420p, with the index at the front."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from numpy.typing import NDArray

from icage.errors import OutputError

_OPTIONS = ["-crf", "20", "-preset", "medium", "-movflags", "+faststart"]


def write_mp4(
    frames: Iterable[NDArray[np.uint8]], path: Path, size: tuple[int, int], fps: int
) -> int:
    """Write frames (height, width, 4); returns how many. ``size`` = (width, height), both even.

    Raises
    ------
    OutputError:
        The encoder has ended before all was written, as on a full disk.
    """
    count = 0
    writer = imageio_ffmpeg.write_frames(
        str(path),
        size,
        fps=fps,
        pix_fmt_in="rgba",
        pix_fmt_out="yuv420p",
        codec="libx264",
        quality=None,  # pyright: ignore[reportArgumentType]  # None leaves it to the codec
        macro_block_size=2,
        output_params=_OPTIONS,
        ffmpeg_log_level="error",
    )
    writer.send(None)
    try:
        for frame in frames:
            _send(writer, frame, path)
            count += 1
    finally:
        writer.close()
    return count


def _send(writer: Generator[None, object], frame: NDArray[np.uint8], path: Path) -> None:
    try:
        writer.send(np.ascontiguousarray(frame))
    except OSError as error:
        last = (str(error).strip().splitlines() or [""])[-1]
        raise OutputError(
            f"{path.name} cannot be written: the encoder has ended: {last}"
        ) from error
