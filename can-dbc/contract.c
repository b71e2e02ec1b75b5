/* SPDX-License-Identifier: MIT
 * Our bus contract as constant tables, from contract.def.
 */
#include "contract.h"

static const struct dbc_value values[] = {
#define VALUE(sig, name, raw, text) {raw, text},
#include "contract.def"
};

const struct dbc_signal contract_signal[CONTRACT_SIGNALS] = {
#define SIGNAL(msg, name_, unit_, scale_, offset_, min_, max_, first, n, mux_, mux_value_, start_, \
	       len_, big, sign)                                                                    \
	[msg##_##name_] = {                                                                        \
		.name = #name_,                                                                    \
		.unit = unit_,                                                                     \
		.scale = scale_,                                                                   \
		.offset = offset_,                                                                 \
		.min = min_,                                                                       \
		.max = max_,                                                                       \
		.values = &values[first],                                                          \
		.n_values = n,                                                                     \
		.mux_value = mux_value_,                                                           \
		.start = start_,                                                                   \
		.len = len_,                                                                       \
		.big_endian = big,                                                                 \
		.is_signed = sign,                                                                 \
		.mux = mux_,                                                                       \
	},
#include "contract.def"
};

const struct dbc_message contract_message[CONTRACT_MESSAGES] = {
#define MESSAGE(name_, id_, cycle, size_, fd, first, n, mux_, ...) \
	[name_] = {                                                \
		.name = #name_,                                    \
		.id = id_,                                         \
		.cycle_ms = cycle,                                 \
		.size = size_,                                     \
		.is_fd = fd,                                       \
		.has_data_id = 1,                                  \
		.data_id = {__VA_ARGS__},                          \
		.signals = &contract_signal[first],                \
		.mux = mux_,                                       \
		.n_signals = n,                                    \
	},
#include "contract.def"
};

const struct dbc contract = {contract_message, CONTRACT_MESSAGES, NULL};

uint16_t contract_hash(void)
{
	uint64_t h = dbc_hash(&contract);
	return (uint16_t)(h ^ h >> 16 ^ h >> 32 ^ h >> 48);
}
