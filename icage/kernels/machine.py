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
from numba.core import cgutils, pythonapi
from numba.core.event import Event, Listener, register
from numba.core.runtime.nrt import rtsys

from icage.kernels.compiling import announce
from icage.kernels.digest import Sources, kernel_sources

TOOLS: Final = f"numba{numba.__version__}-llvmlite{llvmlite.__version__}"
"""What makes the machine code."""

_INNER: Final = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""What only other kernels call needs no way in from Python, which would be compiled with it."""

_OURS: Final = ("icage.", "sim.", "tests")
"""Modules whose named tuples and enumerations are handed to Python as below."""

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
        _ready_to_compile()
        return _kept(numba.njit(**options)(function))
    # private names of numba's, checked by a test: without them the cache would go stale unseen
    cache = dispatcher._cache
    cache._cache_file = _index_of(type(cache._cache_file))(
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


@lru_cache(maxsize=1)
def _index_of(usual: Any) -> Any:
    """The index of a cache, which is empty where it cannot be read: so is a stale one.

    It names the classes of arguments. Where one was renamed since, numba found no such class.
    """

    class Index(usual):
        def _load_index(self) -> Any:
            try:
                return super()._load_index()
            except OSError:
                raise
            except Exception:
                return {}

    return Index


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
        _ready_to_compile()
        return None

    return load


def _hand_over_safely() -> None:
    """Let machine code stop where a signal that came during a call is raised while it hands over.

    The first Python that is run after a long search is what makes its answer an object: there
    Ctrl-C, or any handler that raises, is heard of. numba does not ask whether an object came of
    it, goes on without one, and the process dies. Here no class is looked up or called in Python,
    and where there is no object the call ends with what was raised.
    """
    import_module("numba.core.boxing")
    registry: Any = pythonapi  # a private name of numba's, checked by a test
    by_type = registry._boxers.functions

    def constant(c: Any, value: object) -> Any:
        return c.env_manager.read_const(c.env_manager.add_const(value))

    def items(typ: Any, value: Any, c: Any) -> Any:
        builder = c.builder
        made = cgutils.alloca_once_value(builder, c.pyapi.get_null_object())
        end = builder.append_basic_block("end")
        whole = c.pyapi.tuple_new(typ.count)
        for k, of_item in enumerate(typ):
            item = c.box(of_item, builder.extract_value(value, k))
            with builder.if_then(cgutils.is_null(builder, item), likely=False):
                c.pyapi.decref(whole)
                builder.branch(end)
            c.pyapi.tuple_setitem(whole, k, item)
        builder.store(whole, made)
        builder.branch(end)
        builder.position_at_end(end)
        return builder.load(made)

    def named(typ: Any, value: Any, c: Any) -> Any:
        builder = c.builder
        made = cgutils.alloca_once_value(builder, c.pyapi.get_null_object())
        whole = items(typ, value, c)
        with cgutils.if_likely(builder, cgutils.is_not_null(builder, whole)):
            new, of_class = constant(c, tuple.__new__), constant(c, typ.instance_class)
            builder.store(c.pyapi.call_function_objargs(new, (of_class, whole)), made)
            c.pyapi.decref(whole)
        return builder.load(made)

    def member(typ: Any, value: Any, c: Any) -> Any:
        known = constant(c, {one.value: one for one in typ.instance_class})
        key = c.box(typ.dtype, value)
        found = c.pyapi.dict_getitem(known, key)
        c.pyapi.incref(found)
        c.pyapi.decref(key)
        return found

    def instead_of(usual: Any, ours: Any) -> Any:
        def box(typ: Any, value: Any, c: Any) -> Any:
            is_ours = typ.instance_class.__module__.startswith(_OURS)
            return (ours if is_ours else usual)(typ, value, c)

        return box

    for one in (numba.types.NamedTuple, numba.types.NamedUniTuple):
        by_type[one] = instead_of(by_type[one], named)
    by_type[numba.types.Tuple] = by_type[numba.types.UniTuple] = items
    by_type[numba.types.EnumMember] = instead_of(by_type[numba.types.EnumMember], member)


@lru_cache(maxsize=1)
def _ready_to_compile() -> None:
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
    _hand_over_safely()


register("numba:compile", _Watch())
