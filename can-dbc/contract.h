/* SPDX-License-Identifier: MIT
 * Our bus contract, aebmc.dbc, compiled in: a file edited on the target must not change what a brake controller reads.
 * contract.def is written from aebmc.dbc by `build/tests/test_contract --generate > can-dbc/contract.def`; a test holds
 * the two equal. Names here are the DBC's: message AEB_REQUEST, signal AEB_REQUEST_DECEL, value AEB_REQUEST_STAGE_FULL.
 * Example: codec_set_phys(&contract_signal[AEB_REQUEST_DECEL], data, -6.0);
 */
#ifndef AEBMC_CONTRACT_H
#define AEBMC_CONTRACT_H

#include "dbc.h"

/* Index into contract_message. */
enum contract_message {
#define MESSAGE(name, ...) name,
#include "contract.def"
	CONTRACT_MESSAGES
};

/* Index into contract_signal. */
enum contract_signal {
#define SIGNAL(msg, name, ...) msg##_##name,
#include "contract.def"
	CONTRACT_SIGNALS
};

/* Named raw values. */
enum contract_value {
#define VALUE(sig, name, raw, text) sig##_##name = raw,
#include "contract.def"
};

extern const struct dbc contract;
extern const struct dbc_message contract_message[CONTRACT_MESSAGES];
extern const struct dbc_signal contract_signal[CONTRACT_SIGNALS];

/** contract_hash - 16-bit hash of the contract: dbc_hash() folded by exclusive or. */
uint16_t contract_hash(void);

#endif
