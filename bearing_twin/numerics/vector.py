# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Numba calls these functions while it compiles; its own interfaces have no types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call,no-any-unimported,misc"
"""
Vector types for compiled code: sixteen single-precision numbers as one value.

By itself the compiler vectorises loops over arrays with 256 bits only, only where it can prove
that arrays do not overlap, and it writes every result to memory. A value of `FLOATS` is one
register of 512 bits, two of 256 or four of 128, depending on the processor. Operators act on each
number; the other operand may be a scalar. Vectors exist in compiled code only.
"""

from __future__ import annotations

import math
import operator
from typing import Any

from bearing_twin.numerics.compiled import compiled, FAST
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.datamodel import models
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, overload, register_model
import numpy as np
import numpy.typing as npt

L = 16
"""Lanes: numbers in one vector value."""
_F = np.float32
_LN2 = _F(math.log(2.0))

_intrinsic: Any = intrinsic
"""Typed as Any: compiled code passes other arguments than the Python function declares."""
_BYTES = 64
"""Length of a cache line; a value that crosses one is loaded twice."""
_FLAGS = ('contract', 'nsz', 'arcp', 'nnan', 'ninf')
_FLOAT = ir.FloatType()
_VECTOR = ir.VectorType(_FLOAT, L)
_BITS = ir.VectorType(ir.IntType(1), L)
_INT = ir.IntType(32)
_INTS = ir.VectorType(_INT, L)
_LONG = ir.IntType(64)
_LONGS = ir.VectorType(_LONG, L)


class _Lanes(types.Type):
    """Numba type of a vector of sixteen values; `_LANES` lists the element types."""


FLOATS, MASK, WORDS = (_Lanes(f'{name}{L}') for name in ('Floats', 'Mask', 'Words'))
_LANES = {FLOATS: _VECTOR, MASK: _BITS, WORDS: _LONGS}


@register_model(_Lanes)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, _LANES[kind])


def aligned(shape: tuple[int, ...], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """
    Return an array of zeros that begins at a cache line.

    Examples
    --------
    >>> aligned((2, 16), np.float32).ctypes.data % 64
    0

    """
    size = math.prod(shape) * np.dtype(dtype).itemsize
    room = np.zeros(size + _BYTES, np.uint8)
    begin = -room.ctypes.data % _BYTES
    return room[begin : begin + size].view(dtype).reshape(shape)


_SCALARS = (types.float32, types.float64)
_WORD_PAIRS = ((WORDS, WORDS), (WORDS, types.uint64), (types.uint64, WORDS))
_PAIRS = ((FLOATS, FLOATS), *((FLOATS, s) for s in _SCALARS), *((s, FLOATS) for s in _SCALARS))


def _same(builder, value, kind):
    """Repeat a scalar in all lanes; return a vector as it is."""
    if kind in (FLOATS, WORDS):
        return value
    if kind == types.float64:
        value = builder.fptrunc(value, _FLOAT)
    nothing = ir.Constant(ir.VectorType(value.type, L), ir.Undefined)
    one = builder.insert_element(nothing, value, ir.Constant(_INT, 0))
    return builder.shuffle_vector(one, nothing, ir.Constant(_INTS, None))


def _declare(function, *signatures) -> None:
    """Declare the type signatures of an operator to numba."""
    infer_global(function)(type(function.__name__, (ConcreteTemplate,), {'cases': signatures}))


def _define(function, result, build, pairs=_PAIRS) -> None:
    """Define the code of an operator for two vectors, or a vector and a scalar."""
    _declare(function, *(signature(result, *pair) for pair in pairs))

    def code(context, builder, sig, args):
        return build(builder, *(_same(builder, a, k) for a, k in zip(args, sig.args, strict=True)))

    for pair in pairs:
        lower_builtin(function, *pair)(code)


def _calls(name, **options):
    return lambda builder, a, b: getattr(builder, name)(a, b, **options)


def _comparison(sign):
    return lambda builder, a, b: builder.fcmp_ordered(sign, a, b)


for _names, _name in (
    ('add iadd', 'fadd'), ('sub isub', 'fsub'), ('mul imul', 'fmul'), ('truediv itruediv', 'fdiv')
):  # fmt: skip
    for _each in _names.split():
        _define(getattr(operator, _each), FLOATS, _calls(_name, flags=_FLAGS))
for _operator, _name in ((operator.gt, '>'), (operator.ge, '>='), (operator.eq, '==')):
    _define(_operator, MASK, _comparison(_name))
for _name in ('add', 'mul', 'and_', 'xor'):
    _define(getattr(operator, _name), WORDS, _calls(_name), _WORD_PAIRS)
_define(operator.rshift, WORDS, _calls('lshr'), _WORD_PAIRS)


_declare(operator.and_, signature(MASK, MASK, MASK))
_declare(operator.neg, signature(FLOATS, FLOATS))


@lower_builtin(operator.and_, MASK, MASK)
def _and(context, builder, sig, args):
    return builder.and_(*args)


@lower_builtin(operator.neg, FLOATS)
def _negative(context, builder, sig, args):
    return builder.fsub(ir.Constant(_VECTOR, [-0.0] * L), args[0], flags=_FLAGS)


def _place(context, builder, array, kind, row, vector=_VECTOR):
    """Pointer to a row of ``array``."""
    data = context.make_array(kind)(context, builder, array).data
    index = builder.mul(row, ir.Constant(row.type, L))
    return builder.bitcast(builder.gep(data, [index]), vector.as_pointer())


@_intrinsic
def load(typing, array, row):
    """Load elements ``16 row`` to ``16 row + 15`` of a flat float32 or uint64 array."""
    lanes = FLOATS if array.dtype is types.float32 else WORDS

    def code(context, builder, sig, args):
        place = _place(context, builder, args[0], sig.args[0], args[1], _LANES[lanes])
        value = builder.load(place)
        value.align = array.dtype.bitwidth // 8
        return value

    return lanes(array, types.intp), code


@_intrinsic
def load_from(typing, address, row):
    """Load sixteen float32 that begin ``64 row`` bytes after an address."""

    def code(context, builder, sig, args):
        place = builder.inttoptr(args[0], _VECTOR.as_pointer())
        value = builder.load(builder.gep(place, [args[1]]))
        value.align = 4
        return value

    return FLOATS(types.intp, types.intp), code


def _pairs_at(context, builder, sig, args):
    """Return a pointer to element ``begins[16 row + k] + 2 pair[k]`` of an array per lane."""
    data = context.make_array(sig.args[0])(context, builder, args[0]).data
    firsts = builder.load(_place(context, builder, args[1], sig.args[1], args[2], _LONGS))
    firsts.align = 8
    pairs = builder.sext(builder.fptosi(args[3], _INTS), _LONGS)
    places = builder.add(firsts, builder.add(pairs, pairs))
    each = (builder.extract_element(places, ir.Constant(_INT, k)) for k in range(L))
    return [builder.gep(data, [place]) for place in each]


@_intrinsic
def load_fours(typing, array, begins, row, pair):
    """
    Load four consecutive elements of a flat float32 array per lane, as four vectors.

    Lane k begins at ``begins[16 row + k] + 2 pair[k]``; ``begins`` is an int64 array.
    """

    def code(context, builder, sig, args):
        fours = []
        for place in _pairs_at(context, builder, sig, args):
            four = builder.load(builder.bitcast(place, ir.VectorType(_FLOAT, 4).as_pointer()))
            four.align = 4
            fours.append(four)

        def joined(one, other):
            count = 2 * one.type.count
            order = ir.Constant(ir.VectorType(_INT, count), list(range(count)))
            return builder.shuffle_vector(one, other, order)

        def mixed(one, other, order):
            # The same order in each quarter; from 16 on it counts in the other vector.
            places = [k + 4 * quarter for quarter in range(4) for k in order]
            return builder.shuffle_vector(one, other, ir.Constant(_INTS, places))

        # Every fourth lane end to end; then the rows of each quarter become its columns. In any
        # other order processors need twice the instructions.
        one, two, three, four = (
            joined(joined(fours[k], fours[k + 4]), joined(fours[k + 8], fours[k + 12]))
            for k in range(4)
        )
        found = []
        for order in ((0, 16, 1, 17), (2, 18, 3, 19)):
            left, right = mixed(one, two, order), mixed(three, four, order)
            found += [mixed(left, right, (0, 1, 16, 17)), mixed(left, right, (2, 3, 18, 19))]
        return context.make_tuple(builder, sig.return_type, found)

    return types.UniTuple(FLOATS, 4)(array, begins, types.intp, FLOATS), code


@_intrinsic
def fetch_fours(typing, array, begins, row, pair):
    """Bring the cache lines at the places of `load_fours` into the cache."""

    def code(context, builder, sig, args):
        kinds = [ir.IntType(8).as_pointer(), _INT, _INT, _INT]
        fetch = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(ir.VoidType(), kinds), 'llvm.prefetch.p0i8'
        )
        for place in _pairs_at(context, builder, sig, args):
            numbers = (ir.Constant(_INT, n) for n in (0, 3, 1))
            builder.call(fetch, [builder.bitcast(place, kinds[0]), *numbers])
        return context.get_dummy_value()

    return types.void(array, begins, types.intp, FLOATS), code


@_intrinsic
def store(typing, array, row, value):
    """Store sixteen numbers in a flat float32 array, from element ``16 row`` on."""

    def code(context, builder, sig, args):
        place = _place(context, builder, args[0], sig.args[0], args[1])
        builder.store(args[2], place).align = 4
        return context.get_dummy_value()

    return types.void(array, types.intp, FLOATS), code


@_intrinsic
def splat(typing, scalar):
    """Return a vector with the same float32 or uint64 in all lanes."""

    def code(context, builder, sig, args):
        return _same(builder, args[0], scalar)

    return (WORDS if scalar == types.uint64 else FLOATS)(scalar), code


@_intrinsic
def chosen(typing, mask, value, other):
    """``value`` where the mask is set, ``other`` elsewhere; for vectors, or scalars and a bool."""
    kind = FLOATS if mask is MASK else types.float64

    def code(context, builder, sig, args):
        whole = [
            _same(builder, given, each)
            if mask is MASK
            else context.cast(builder, given, each, kind)
            for given, each in zip(args[1:], sig.args[1:], strict=True)
        ]
        return builder.select(args[0], *whole)

    return kind(mask, value, other), code


@_intrinsic
def any_of(typing, mask):
    """Whether the mask is set in any lane; a bool is returned as it is."""

    def code(context, builder, sig, args):
        if mask is not MASK:
            return args[0]
        bits = builder.bitcast(args[0], ir.IntType(L))
        return builder.icmp_unsigned('!=', bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), code


@_intrinsic
def highest(typing, value):
    """Highest of sixteen numbers."""

    def code(context, builder, sig, args):
        function = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(_FLOAT, [_VECTOR]),
            f'llvm.vector.reduce.fmax.v{L}f32',
        )
        return builder.call(function, args, fastmath=_FLAGS)

    return types.float32(value), code


def _function(name):
    """Return an LLVM intrinsic of this name for compiled code; it takes a vector or a scalar."""

    def declared(typing, value):
        lanes = value is FLOATS
        kind, suffix = (_VECTOR, f'v{L}f32') if lanes else (ir.DoubleType(), 'f64')

        def code(context, builder, sig, args):
            function = cgutils.get_or_insert_function(
                builder.module, ir.FunctionType(kind, [kind]), f'llvm.{name}.{suffix}'
            )
            return builder.call(function, args, fastmath=_FLAGS if lanes else ())

        return (FLOATS(FLOATS) if lanes else types.float64(types.float64)), code

    return _intrinsic(declared)


root, magnitude, floor = (_function(name) for name in ('sqrt', 'fabs', 'floor'))
"""Square root, absolute value, and rounding down, per lane."""


@compiled(inline=True, fast=FAST)
def sines(angle):
    """Cosine and sine of an angle within +-pi/4, rad, to 1e-7; for scalars or vectors."""
    square = angle * angle
    c = _F(2.443315711809948e-5) * square - _F(1.388731625493765e-3)
    c = _F(1.0) - square * (_F(0.5) - square * (c * square + _F(4.166664568298827e-2)))
    s = _F(-1.9515295891e-4) * square + _F(8.3321608736e-3)
    s = angle + angle * square * (s * square - _F(1.6666654611e-1))
    return c, s


def cosine_sine(angle: Any) -> tuple[Any, Any]:
    """
    Cosine and sine of an angle within +-pi, rad: of a scalar, or of a vector to 5e-7.

    Examples
    --------
    >>> import numba
    >>> numba.njit(lambda angle: cosine_sine(angle))(0.0)
    (1.0, 0.0)

    """
    raise NotImplementedError('called from compiled code only')


@overload(cosine_sine)
def _cosine_sine(angle):
    def of_number(angle):
        return math.cos(angle), math.sin(angle)

    def of_lanes(angle):
        # Cosine and sine of a quarter of the angle, then two double-angle steps.
        c, s = sines(angle * 0.25)
        c, s = 1.0 - 2.0 * (s * s), 2.0 * (s * c)
        return 1.0 - 2.0 * (s * s), 2.0 * (s * c)

    return of_lanes if angle is FLOATS else of_number


@_intrinsic
def real(typing, words):
    """Convert integers below 2^31 (`WORDS`) to `FLOATS`."""

    def code(context, builder, sig, args):
        return builder.sitofp(builder.trunc(args[0], _INTS), _VECTOR)

    return FLOATS(WORDS), code


@_intrinsic
def has_bit(typing, words, bit):
    """Return the mask of the lanes whose bit number ``bit`` is set."""

    def code(context, builder, sig, args):
        one = _same(builder, builder.shl(ir.Constant(_LONG, 1), args[1]), types.uint64)
        return builder.icmp_unsigned('!=', builder.and_(args[0], one), ir.Constant(_LONGS, None))

    return MASK(WORDS, types.uint64), code


@_intrinsic
def split(typing, value):
    """Split positive numbers into exponents of 2 and mantissas from 0.707 to 1.414."""

    def code(context, builder, sig, args):
        bits = builder.bitcast(args[0], _INTS)
        root_half = ir.Constant(_INTS, [0x3F3504F3] * L)
        digits = ir.Constant(_INTS, [23] * L)
        exponent = builder.ashr(builder.sub(bits, root_half), digits)
        rest = builder.bitcast(builder.sub(bits, builder.shl(exponent, digits)), _VECTOR)
        pair = builder.sitofp(exponent, _VECTOR), rest
        return context.make_tuple(builder, sig.return_type, pair)

    return types.UniTuple(FLOATS, 2)(FLOATS), code


@compiled(inline=True, fast=FAST)
def logarithm(exponent: Any, rest: Any) -> Any:
    """Return the natural logarithm of ``rest 2^exponent``, to 1e-7, see `split`."""
    # The polynomial of Cephes' logf.
    t = rest - _F(1.0)
    p = _F(7.0376836292e-2) * t - _F(1.1514610310e-1)
    p = p * t + _F(1.1676998740e-1)
    p = p * t - _F(1.2420140846e-1)
    p = p * t + _F(1.4249322787e-1)
    p = p * t - _F(1.6668057665e-1)
    p = p * t + _F(2.0000714765e-1)
    p = p * t - _F(2.4999993993e-1)
    p = p * t + _F(3.3333331174e-1)
    square = t * t
    return exponent * _LN2 + (t - _F(0.5) * square + square * t * p)
