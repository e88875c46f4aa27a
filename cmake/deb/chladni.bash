# Completion of chladni for bash. Verbs and options are those that the program itself tells.
_chladni() {
  local word=${COMP_WORDS[COMP_CWORD]} verb=${COMP_WORDS[1]} program=${COMP_WORDS[0]}
  local choices=()
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t choices < <("$program" --help 2>/dev/null |
      awk '/^Subcommands:/ { on = 1; next } on && /^  [a-z]/ { print $1 }')
    choices+=(--help --version)
  elif [[ $word == -* ]]; then
    mapfile -t choices < <("$program" "$verb" --help 2>/dev/null | grep -oE -- '--[a-z][a-z-]*' | sort -u)
  elif [[ $verb == list ]]; then
    mapfile -t choices < <("$program" list --help 2>/dev/null |
      grep -oE '\{[a-z,]+\}' | tr -d '{}' | tr ',' '\n')
  else
    compopt -o filenames 2>/dev/null
    local pattern='!*.toml'
    [[ $verb == convert || $verb == check || $verb == figure ]] && pattern=''
    mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -f -X "$pattern" -- "$word")
    return
  fi
  mapfile -t COMPREPLY < <(compgen -W "${choices[*]}" -- "$word")
}
complete -F _chladni chladni
