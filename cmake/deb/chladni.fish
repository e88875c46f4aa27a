# Completion of chladni for fish. Verbs and options are those that the program itself tells.
complete -c chladni -n __fish_use_subcommand -f -a "(chladni --help 2>/dev/null | \
  awk '/^Subcommands:/ { on = 1; next } on && /^  [a-z]/ { verb = \$1; \$1 = \"\"; print verb \"\t\" substr(\$0, 2) }')"
complete -c chladni -n 'not __fish_use_subcommand' -a "(chladni (commandline -opc)[2] --help 2>/dev/null | \
  grep -oE -- '--[a-z][a-z-]*' | sort -u)"
