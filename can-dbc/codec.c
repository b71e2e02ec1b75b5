/* SPDX-License-Identifier: MIT
 * Signals out of frames and into frames.
 */
#include <errno.h>
#include <math.h>
#include "codec.h"

uint64_t codec_mask(const struct dbc_signal *sig)
{
	return UINT64_MAX >> (64 - sig->len);
}

/*
 * Where bit @i of the raw value (0 the least significant) lies in the frame. The file counts from a big-endian signal's
 * most significant bit, and there the bit that follows the lowest of a byte is the highest of the next byte; with the
 * bits of each byte numbered the other way round (^ 7) that is plain counting.
 */
static unsigned bit_at(const struct dbc_signal *sig, unsigned i)
{
	return sig->big_endian ? ((sig->start ^ 7u) + sig->len - 1 - i) ^ 7u : sig->start + i;
}

uint64_t codec_raw(const struct dbc_signal *sig, const uint8_t *data)
{
	uint64_t raw = 0;
	for (unsigned i = 0; i < sig->len; i++) {
		unsigned bit = bit_at(sig, i);
		raw |= (uint64_t)(data[bit / 8] >> bit % 8 & 1) << i;
	}
	return raw;
}

int codec_set_raw(const struct dbc_signal *sig, uint8_t *data, uint64_t raw)
{
	if (raw > codec_mask(sig)) {
		return -ERANGE;
	}
	for (unsigned i = 0; i < sig->len; i++) {
		unsigned bit = bit_at(sig, i);
		uint8_t one = (uint8_t)(1u << bit % 8);
		data[bit / 8] =
			(uint8_t)(raw >> i & 1 ? data[bit / 8] | one : data[bit / 8] & ~one);
	}
	return 0;
}

int codec_present(const struct dbc_message *msg, const struct dbc_signal *sig, const uint8_t *data)
{
	return sig->mux != DBC_MULTIPLEXED || codec_raw(msg->mux, data) == sig->mux_value;
}

int64_t codec_int(const struct dbc_signal *sig, uint64_t raw)
{
	uint64_t sign = sig->is_signed ? (codec_mask(sig) >> 1) + 1 : 0;
	return (int64_t)((raw ^ sign) - sign);
}

int codec_set_int(const struct dbc_signal *sig, uint8_t *data, int64_t value)
{
	uint64_t raw = (uint64_t)value & codec_mask(sig);
	if (codec_int(sig, raw) != value || (value < 0 && !sig->is_signed)) {
		return -ERANGE;
	}
	return codec_set_raw(sig, data, raw);
}

double codec_phys(const struct dbc_signal *sig, uint64_t raw)
{
	double v = sig->is_signed ? (double)codec_int(sig, raw) : (double)raw;
	return v * sig->scale + sig->offset;
}

int codec_in_range(const struct dbc_signal *sig, uint64_t raw)
{
	if (sig->min == 0 && sig->max == 0) {
		return 1;
	}
	double v = codec_phys(sig, raw);
	double half = fabs(sig->scale) / 2;
	return v >= sig->min - half && v <= sig->max + half;
}

int codec_set_phys(const struct dbc_signal *sig, uint8_t *data, double value)
{
	double steps = (value - sig->offset) / sig->scale;
	double whole = floor(steps);
	whole += steps - whole >= 0.5;
	double low = sig->is_signed ? -ldexp(1, sig->len - 1) : 0;
	double high = ldexp(1, sig->len - sig->is_signed);
	if (!(whole >= low && whole < high)) {
		return -ERANGE;
	}
	uint64_t raw = whole < 0 ? (uint64_t)(int64_t)whole : (uint64_t)whole;
	raw &= codec_mask(sig);
	return codec_in_range(sig, raw) ? codec_set_raw(sig, data, raw) : -ERANGE;
}
