"""Machine code of the kernels: numba and its cache. Imported when the first kernel needs it.

numba's own cache asks only whether the file of a function has changed, not the files of the
functions it calls: after an update that touches one kernel, its callers would go on running the
old machine code without a word. Here the stamp is the content of all kernel files together.
Environments that share a checkout do not share the cache, or each would make the other's stale:
the versions of numba and llvmlite are part of its files' names, as Python's is by numba's doing.
The simulator's loops are kept in the same way.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from importlib import import_module
from typing import Any, Final

import llvmlite
import numba
from numba.core.event import Event, Listener, register
from numba.core.runtime.nrt import rtsys

from icage.kernels.compiling import announce
from icage.kernels.digest import Sources, kernel_sources

TOOLS: Final = f"numba{numba.__version__}-llvmlite{llvmlite.__version__}"
"""What makes the machine code."""

_INNER: Final = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""What only other kernels call needs no way in from Python, which would be compiled with it."""

_dispatchers: list[Any] = []
"""All kernels of this process that have met numba."""


def dispatcher_of(function: Callable[..., Any], borrows: bool = False) -> Any:
    """The function, to be compiled without fast-math and cached on disk.

    Kernels touch no Python object, so they release its lock and threads share the cores.
    """
    return _kernel(function, TOOLS, borrows)


def inner_dispatcher_of(function: Callable[..., Any], borrows: bool = False) -> Any:
    """The function as other kernels call it."""
    return _kernel(function, f"inner.{TOOLS}", borrows, **_INNER)


def _kernel(function: Callable[..., Any], suffix: str, borrows: bool, **options: Any) -> Any:
    # what counts no references cannot make an array; said of every kernel, for one that does not
    # say is compiled as its first caller is
    options |= {"fastmath": False, "nogil": True, "_nrt": not borrows}
    return stamped(function, kernel_sources(), suffix, **options)


def stamped(
    function: Callable[..., Any], sources: Sources, suffix: str = TOOLS, **options: Any
) -> Any:
    """The function, to be compiled and cached on disk under the digest of all of its sources.

    Where numba may write a cache neither beside the file nor into the user's own folder, every
    process compiles for itself.
    """
    try:
        dispatcher: Any = numba.njit(cache=True, **options)(function)
    except RuntimeError:
        _load_without_blas()
        return _kept(numba.njit(**options)(function))
    # private names of numba's, checked by a test: without them the cache would go stale unseen
    cache = dispatcher._cache
    cache._cache_file = type(cache._cache_file)(
        cache_path=cache.cache_path,
        filename_base=f"{cache._impl.filename_base}.{suffix}",
        source_stamp=sources.digest,
    )
    cache.load_overload = _without_what_compiles(cache)
    cache.save_overload = _while_unchanged(sources, cache.save_overload)
    return _kept(dispatcher)


def _kept(dispatcher: Any) -> Any:
    """The dispatcher; a call with a number written out is one with any number.

    numba would compile a kernel once more for each number that stands in a call from another one,
    though nothing is gained: what is called is put into its caller anyway. It was a sixth of the
    time of all kernels.
    """
    asked = dispatcher.get_call_template

    def of_any_number(args: Any, kws: dict[str, Any]) -> Any:
        return asked(
            [numba.types.unliteral(one) for one in args],
            {name: numba.types.unliteral(one) for name, one in kws.items()},
        )

    dispatcher.get_call_template = of_any_number
    _dispatchers.append(dispatcher)
    return dispatcher


class _Watch(Listener):
    """Announces the first compilation, unless some kernel came from the cache."""

    def on_start(self, event: Event) -> None:
        kernel = (event.data or {}).get("dispatcher")
        if kernel in _dispatchers and not any(one.stats.cache_hits for one in _dispatchers):
            announce()

    def on_end(self, event: Event) -> None:
        pass


def _while_unchanged(
    sources: Sources, save: Callable[[Any, Any], None]
) -> Callable[[Any, Any], None]:
    """Keeps machine code only while the sources are those of the stamp.

    A process that runs on across an update would leave that of the old ones under the new stamp.
    """

    def save_if_so(signature: Any, machine_code: Any) -> None:
        if not sources.changed():
            save(signature, machine_code)

    return save_if_so


def _without_what_compiles(cache: Any) -> Callable[[Any, Any], Any]:
    """How a cache finds machine code: by what runs it, without what compiles.

    numba first loads all that it could compile, hundreds of functions, which takes as long as the
    rest of it. That follows here only where nothing is found; what compiles asks for it again.
    """

    def load(signature: Any, target: Any) -> Any:
        rtsys.initialize(target)
        with cache._guard_against_spurious_io_errors():
            found = cache._load_overload(signature, target)
            if found is not None:
                return found
        _load_without_blas()
        return None

    return load


@lru_cache(maxsize=1)
def _load_without_blas() -> None:
    """Load what numba has for arrays, but not scipy.

    numba asks there whether scipy's BLAS is at hand, which takes as long as a plan. No kernel uses
    it, and scipy is among our requirements: for others the answer is yes, too.
    """
    numba_linalg: Any = import_module("numba.np.linalg")
    asks = numba_linalg.ensure_blas
    numba_linalg.ensure_blas = lambda: None
    try:
        import_module("numba.np.arraymath")
    finally:
        numba_linalg.ensure_blas = asks


register("numba:compile", _Watch())
