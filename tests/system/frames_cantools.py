#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""usage: frames_cantools.py FRAMES.log WORDS: our frames, as candump wrote them in the virtual machine, decoded by cantools
with can-dbc/aebmc.dbc, against the words of `aebmc decode`: message, state, stage, request and evaluation."""
import re
import sys

import cantools

db = cantools.database.load_file("can-dbc/aebmc.dbc")
frames = [re.match(r"\(.*\) \S+ ([0-9A-F]+)#([0-9A-F]*)", line).groups() for line in open(sys.argv[1])]
words = open(sys.argv[2]).read().splitlines()
if len(frames) != len(words) or not frames:
    sys.exit("%d frames, %d lines of words" % (len(frames), len(words)))
compared = 0
names = set()
for (identifier, data), line in zip(frames, words):
    message = db.get_message_by_frame_id(int(identifier, 16))
    signals = message.decode(bytes.fromhex(data))
    names.add(message.name)
    if " %s:" % message.name not in line:
        sys.exit("cantools says %s of: %s" % (message.name, line))
    for signal, word in (("STATE", "state"), ("STAGE", "stage"), ("REQUEST", "request"), ("EVAL_ID", "evaluation")):
        told = re.search(r"\b%s ([A-Za-z0-9]+)" % word, line)
        if signal in signals and told and told.group(1) != "none":
            compared += 1
            if str(signals[signal]) != told.group(1):
                sys.exit("%s %s, but: %s" % (signal, signals[signal], line))
print("# %d frames of %d messages, %d values compared" % (len(frames), len(names), compared))
sys.exit(0 if len(names) == 5 and compared >= len(frames) else "too few: %s" % sorted(names))
