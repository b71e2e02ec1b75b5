# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Completion of aebmc in bash: subcommands and options as `aebmc help` prints them.
_aebmc()
{
	local cur=${COMP_WORDS[COMP_CWORD]} words
	if [ "$COMP_CWORD" -eq 1 ]; then
		words="help --version $("$1" help | sed -n 's/^  \([a-z]*\) .*/\1/p')"
	elif [[ ${COMP_WORDS[1]} == help ]]; then
		words=$("$1" help | sed -n 's/^  \([a-z]*\) .*/\1/p')
	elif [[ ${COMP_WORDS[1]} == plot && $COMP_CWORD -eq 2 && $cur != -* ]]; then
		words=$("$1" help plot | tr '\n' ' ' | sed -n 's/.* KIND: \([^;]*\);.*/\1/p' | sed 's/,//g; s/ or / /')
	elif [[ $cur == -* ]]; then
		words=$("$1" help "${COMP_WORDS[1]}" 2>/dev/null | grep -oE -- '--[a-z-]+' | sort -u)
	fi
	mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur"; [ "$COMP_CWORD" -gt 1 ] && compgen -f -- "$cur")
}
complete -o filenames -F _aebmc aebmc
