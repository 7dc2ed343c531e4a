"""One file for each thing that the command does; configuration becomes Python objects here."""
