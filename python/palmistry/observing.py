"""Observers: on scenes of every kind, and on measurements of a system at hand."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from .answers import Observation
from .errors import Error
from .system import System, _asked, _native, _several


def observe(
    scene: System | str | os.PathLike[str],
    data: Any = None,
    *,
    seed: int | None = None,
    studies: bool = False,
    times: bool = True,
    time: str = "time",
    columns: Mapping[str, str] | None = None,
    inputs: Mapping[str, str] | None = None,
    noise: float | Mapping[str, float] | None = None,
    unknowns: Iterable[str] | str | None = None,
    known: Mapping[str, float] | None = None,
    guess: Mapping[str, float] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    method: str | Iterable[str] | None = None,
    window: int | None = None,
    steps: int = 50,
    loss: str | None = None,
    on_fault: str = "stop",
    spike: float | None = None,
    interpolation: str | None = None,
) -> Observation:
    """Runs observers: of a scene, a TOML file of any kind, or of a system on measurements.

    Of a scene: data: measurements as CSV or Parquet in place of the scene's. seed: another one than the scene's. studies: run these too. times: whether `seconds` are given.

    Of a system: data: a pandas.DataFrame, a dict of columns, or the path of a CSV or Parquet file, with the time in s, what each output measures, and what drives the inputs. Columns have
    the names of the model's outputs and inputs, or `columns` says what they are called: {"phi": "angle_deg"}. time: the column of times (of a DataFrame without one its index). inputs: by input field the column that drives it.
    noise: the standard deviation of the outputs' errors, in their units, one for all or by output; estimated from the residuals unless given. unknowns: what is estimated, all unknowns of the system
    unless given. known: values of what is neither estimated nor measured. guess: where the search begins; of what is not named in the middle of its range in the sample box. bounds: between what some of it lies.
    method: 'multiple-shooting' (unless a guess is given), 'trust-region', 'newton', 'kalman', 'unscented', 'smoother', 'high-gain' or 'integration', or several. window: samples of one window, all unless given.
    steps: of the search in each window. loss: 'huber' or another of the book's; squares unless given. on_fault: 'stop' or 'skip' rows that are faulty; spike: how many usual departures make a value one, 8 unless
    given, inf for none. A NaN of an output says that it was not measured then, and is no fault; what drives the model goes between its samples by interpolation: 'polynomial' unless 'linear' or 'hold' is given.

    >>> import numpy, palmistry
    >>> decay = palmistry.System.parse('''
    ...     system "A decay"
    ...     state x
    ...     param k unknown
    ...     drift f  x' = -k*x
    ...     output x
    ...     sample x in [0, 2]  k in [0, 2]
    ... ''')
    >>> t = numpy.linspace(0, 3, 31)
    >>> found = palmistry.observe(decay, {"time": t, "x": numpy.exp(-0.7*t)}, noise=1e-3)
    >>> found.estimates["name"].tolist(), found.estimates["estimate"].round(3).tolist(), found.fits
    (['x', 'k'], [1.0, 0.7], True)
    """
    if not isinstance(scene, System):
        file = None if data is None else os.fspath(data)
        return _asked(Observation, lambda: _native.observe(os.fspath(scene), file, seed, studies, times))
    if data is None:
        raise Error("there are no measurements", "hand over a DataFrame, a dict of columns, or the path of a file")
    if studies:
        raise Error("a study needs the true states, which measurements do not have", "leave out studies")
    path, held = _measurements(data, time)
    length = len(held[0][1]) if held else None
    methods = _several(method) if method is not None else ["trust-region" if guess is not None else "multiple-shooting"]
    if window is None:
        # what a scene may say; too few samples are refused where they are counted
        window = min(max((length if length is not None else _rows(path)) - 1, 2), 1_000_000)
    settings: dict[str, Any] = {
        "methods": methods,
        "estimate": list(_several(unknowns) if unknowns is not None else scene.unknowns),
        "window": int(window),
        "steps": int(steps),
    }
    if guess is None:
        settings["guess"] = "sample"
    else:
        box = scene._native.sample_box()
        middle = {name: sum(box.get(name, (0.0, 0.0))) / 2 for name in settings["estimate"]}
        settings["guess"] = {**middle, **guess}
    said = {"known": known, "inputs": inputs, "bounds": bounds, "loss": loss}
    settings |= {key: value for key, value in said.items() if value is not None}
    lines = [f"title = {_toml(scene.title)}", 'model = "the system"']
    if seed is not None:
        lines.append(f"seed = {_toml(seed)}")
    if isinstance(noise, Mapping):
        for name, deviation in noise.items():
            lines += [f"[sensor.{_toml(name)}]", f"noise = {_toml(float(deviation))}"]
    elif noise is not None:
        lines += ["[sensor]", f"noise = {_toml(float(noise))}"]
    # a scene has to say that its measurements come from elsewhere; that file is not looked for
    lines += ["[data]", 'record = "the measurements.csv"', f"on_fault = {_toml(on_fault)}"]
    lines += [] if spike is None else [f"spike = {_toml(float(spike))}"]
    lines += [] if interpolation is None else [f"interpolation = {_toml(interpolation)}"]
    renamed = dict(columns or {})
    if path is not None and time != "time":
        renamed["time"] = time
    if renamed:
        lines += ["[columns]", *(f"{_toml(name)} = {_toml(other)}" for name, other in renamed.items())]
    lines += ["[observer]", *(f"{key} = {_toml(value)}" for key, value in settings.items())]
    text = "\n".join(lines) + "\n"
    return _asked(Observation, lambda: _native.observe_measured(scene._native, text, path, held, times))


def stream(scene: str | os.PathLike[str], pieces: Iterable[Any], *, times: bool = True) -> Iterator[dict[str, Any]]:
    """Observers on measurements as they arrive: each window's answer as soon as it is there, and at the end an account of all; objects as `palmistry observe SCENE --data - --json` prints.

    pieces: texts or bytes of comma-separated values, the first line with the names of columns; or rows as dicts, of which the first says the names. times: whether `seconds` are given.
    Memory is bounded by a few windows. A break ends the work.

    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = pathlib.Path(folder, "decay.proof").write_text('system "s" state x drift f x\\' = -x output x sample x in [0, 2]')
    ...     scene = pathlib.Path(folder, "scene.toml")
    ...     _ = scene.write_text('title = "s"\\nmodel = "decay.proof"\\n[data]\\nrecord = "-"\\n[sensor]\\nnoise = 1e-3\\n[observer]\\nmethods = ["newton"]\\nestimate = ["x"]\\nguess = "sample"\\nwindow = 5\\n')
    ...     rows = ({"time": 0.1*i, "x": numpy.exp(-0.1*i)} for i in range(11))
    ...     answers = list(palmistry.stream(scene, rows))
    >>> [answer.get("window") for answer in answers]
    [1, 2, None]
    """
    native = _native.Stream(os.fspath(scene), times)
    try:
        names: list[str] | None = None
        for piece in pieces:
            if isinstance(piece, Mapping):
                head = ""
                if names is None:
                    names = [str(name) for name in piece]
                    head = ",".join('"' + name.replace('"', '""') + '"' for name in names) + "\n"
                missing = [name for name in names if name not in piece]
                if missing:
                    raise Error(f"a row has no '{missing[0]}'", f"each has what the first one has: {', '.join(names)}")
                piece = head + ",".join(repr(float(piece[name])) for name in names) + "\n"
            if isinstance(piece, str):
                piece = piece.encode()
            if not isinstance(piece, (bytes, bytearray, memoryview)):
                raise Error(f"a piece of a stream is no {type(piece).__name__}", "it is a text, bytes, or a row as a dict")
            native.put(bytes(piece))
            while (line := native.ready()) is not None:
                yield json.loads(line)
        native.close()
        while (line := native.wait()) is not None:
            yield json.loads(line)
    finally:
        native.stop()


def _toml(value: Any) -> str:
    """A value in TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # as JSON has it, but for what TOML does not take as it is
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_toml(str(key))} = {_toml(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_toml, value)) + "]"
    item = getattr(value, "item", None)  # numpy's scalars
    if item is not None:
        value = item()
    if isinstance(value, (int, float)):
        return repr(value)
    return repr(float(value))


def _measurements(data: Any, time: str) -> tuple[str | None, list[tuple[str, Any]]]:
    """The path of a file, or columns as contiguous doubles with the time among them as 'time'."""
    import numpy

    if isinstance(data, (str, os.PathLike)):
        return os.fspath(data), []
    if hasattr(data, "columns") and hasattr(data, "index"):  # a DataFrame
        held = {str(name): _numbers(data[name]) for name in data.columns}
        if time not in held:
            held[time] = data.index.to_numpy()
    elif isinstance(data, Mapping):
        held = {str(name): data[name] for name in data}
    else:
        raise Error(f"measurements are no {type(data).__name__}", "hand over a DataFrame, a dict of columns, or the path of a file")
    if time not in held:
        raise Error(f"there is no column '{time}'", f"the columns are {', '.join(held)}; say which has the times by time='...'")
    found = []
    for name, values in held.items():
        array = numpy.asarray(values)
        if name == time and array.dtype.kind in "OU":
            array = _dates(array)
        if array.dtype.kind == "M" and array.size:  # dates: from the first one, in s
            array = (array - array[0]) / numpy.timedelta64(1, "s")
        elif array.dtype.kind == "m":
            array = array / numpy.timedelta64(1, "s")
        if array.dtype.kind not in "fiub" or array.ndim != 1:
            continue  # texts and the like: refused by name where the model needs the column
        found.append(("time" if name == time else name, numpy.ascontiguousarray(array, dtype=numpy.float64)))
    if not any(name == "time" for name, _ in found):
        raise Error(f"the column '{time}' does not hold numbers", "times are seconds, or dates of numpy")
    return None, found


def _dates(array: Any) -> Any:
    """Times that are dates as texts, or dates with a zone of pandas; what is neither stays."""
    import numpy

    try:
        plain = [one.isoformat() if hasattr(one, "isoformat") else str(one) for one in array]
        # a year alone is no date, but a number
        if any(len(text) < len("2026-11-28T10:00:00") for text in plain):
            return array
        # of a zone numpy knows nothing: all in one
        zones = {text[19:].lstrip(".0123456789") for text in plain}
        if len(zones) != 1:
            return array
        return numpy.array([text[: len(text) - len(next(iter(zones)))] for text in plain], dtype="datetime64[ns]")
    except ValueError:
        return array


def _numbers(series: Any) -> Any:
    """A column of a DataFrame; what is not there is NaN, also where the column's type is one of pandas's own."""
    if getattr(series.dtype, "kind", "O") in "fiu":
        return series.to_numpy(dtype="float64", na_value=float("nan"))
    return series.to_numpy()


def _rows(path: str | None) -> int:
    """How many samples a file has, at most."""
    assert path is not None
    if path.lower().endswith(".parquet"):
        try:
            import pyarrow.parquet as parquet
        except ImportError as why:
            raise Error("how many rows a Parquet file has is not known without pyarrow", "say window=..., or pip install 'palmistry[tables]'") from why
        return parquet.ParquetFile(path).metadata.num_rows
    with open(path, "rb") as file:
        return max(sum(1 for line in file if line.strip()) - 1, 2)
