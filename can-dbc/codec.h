/* SPDX-License-Identifier: MIT
 * Signals out of frames and into frames. By pointer, no allocation, no look-up: fit for the real-time thread.
 * A raw value is the field's bits as an unsigned number, 0..2^len-1, for signed signals too (two's complement).
 * @data must hold the message's size in bytes: compare the frame's length first.
 */
#ifndef AEBMC_CODEC_H
#define AEBMC_CODEC_H

#include "dbc.h"

/** codec_present - 1 if @sig is in this frame: it is not multiplexed, or the multiplexor selects it. */
int codec_present(const struct dbc_message *msg, const struct dbc_signal *sig, const uint8_t *data);

/** codec_mask - 2^len - 1: the largest raw value, all bits one. */
uint64_t codec_mask(const struct dbc_signal *sig);

/** codec_raw - a signal's raw value. */
uint64_t codec_raw(const struct dbc_signal *sig, const uint8_t *data);

/** codec_set_raw - write a raw value; other bits keep theirs. Returns 0, or -ERANGE (nothing written) if it has more
 * than len bits. */
int codec_set_raw(const struct dbc_signal *sig, uint8_t *data, uint64_t raw);

/** codec_int - the integer that a raw value stands for, exact to 64 bits. (Unsigned 64-bit signals: use raw.) */
int64_t codec_int(const struct dbc_signal *sig, uint64_t raw);

/** codec_set_int - write an integer. Returns 0, or -ERANGE (nothing written) if the signal cannot hold it. */
int codec_set_int(const struct dbc_signal *sig, uint8_t *data, int64_t value);

/**
 * codec_phys - physical value of a raw one: raw * scale + offset, in the DBC's unit
 * Three roundings to f64 (integer to f64, product, sum), no fused operation: the same bits on every machine. Integers
 * beyond 2^53 lose their low bits here, never in raw.
 */
double codec_phys(const struct dbc_signal *sig, uint64_t raw);

/**
 * codec_in_range - 1 if a raw value lies within the range that the DBC gives (to half a step of scale), or if it gives
 * none. A "not available" value belongs outside of the range, so that this finds it.
 */
int codec_in_range(const struct dbc_signal *sig, uint64_t raw);

/**
 * codec_set_phys - write a physical value
 * Rounded to the nearest raw value, ties towards the larger one; never clamped.
 * Returns 0, or -ERANGE (nothing written) for NaN, for what does not fit in len bits and for what is not
 * codec_in_range().
 */
int codec_set_phys(const struct dbc_signal *sig, uint8_t *data, double value);

#endif
