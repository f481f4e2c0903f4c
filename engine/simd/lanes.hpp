#pragma once

/// One kernel text for every instruction set: `Lanes<Real, Isa>` with Isa = simd::Scalar, xsimd::sse2,
/// xsimd::avx2 or xsimd::avx512bw. Included by kernels only, and so by the files of isa/ alone; everything
/// has internal linkage. A lane operation gives the bits of the scalar one: no fma, no approximation.
///
/// `ShortLanes<Real, Isa>` has the same, with at most eight lanes.
///
///   size                 lanes in a batch
///   Number               Real
///   Batch, Mask, Rows    Real lanes; booleans (&, |, !); as many int32 row numbers
///   Batch4, Batch2       four batches, [0] ... [3]; two
///   broadcast(value), load(p), load_unaligned(p), store(p, batch), store_unaligned(p, batch)
///   broadcast_row(row), load_rows(p), store_rows(p, rows)         unaligned
///   rows_sum(a, b)                                                of row numbers
///   gather(column, rows)                                          column[row] a lane
///   gather_at(column, rows*)                                      the same; quicker where rows are in memory
///   scatter_at(column, rows*, batch)                              the same back; of equal rows the last lane
///   compress_store(out, rows, bits)   the lanes whose bit is set, in order, to out; returns how many.
///                                     Writes a whole batch: out needs room for `size` more numbers
///   compress_store(out, batch, bits)  the same for Reals; returns nothing
///   load_rows4(packed, rows*)         records of four Reals -> four batches, e.g. (vx, vy, spin, spare)
///   load_differences4(packed, of*, from*)   records of rows `of` less those of rows `from`, likewise
///   store_rows4(packed, rows*, Batch4)  the same back; of equal rows the last lane wins
///   load_rows2(packed, rows*), store_rows2(packed, rows*, Batch2)  the same for records of two Reals
///
/// On a Batch: + - * / += -= *=, unary -, < <= > >= ==. As free functions in carom::simd, for scalars too:
///   sqrt, abs, min, max (the second operand if one is NaN or both are zeros), select(mask, if_true,
///   if_false), any(mask), all(mask), bitmask(mask) -> unsigned, lane 0 in bit 0,
///   binade (the power of two at or below |value|, with its sign).
///
/// For Real = float also
///   rows_difference(a, b), rows_min(a, b)   of row numbers
///   store_smallest4(p, a, b, c, d)          of each the smallest number, to p[0] ... p[3]
///   store_marked_pairs(to_a, to_b, a, b, word)   for each set bit 16 j + i, in order: a[i] and b[i + j];
///   returns
///                                           how many. to_a and to_b need room for 71 numbers
///
/// For Real = double also
///   load_converted(float* or double*)   unaligned
///   floor(batch), floor_to_rows(batch)  toward minus infinity, |value| < 2^31

#include "simd/scalar_lanes.hpp"

#if defined(__SSE2__)
#include "simd/sse2_lanes.hpp"
#endif
#if defined(__AVX2__)
#include "simd/avx2_lanes.hpp"
#endif
#if defined(__AVX512BW__) && defined(__AVX512DQ__) && defined(__AVX512VL__)
#include "simd/avx512_lanes.hpp"
#endif
