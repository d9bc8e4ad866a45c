"""One module a command: ``add_parser(subparsers)`` says its options, ``run(args)`` does it.

The command line finds the modules of this folder by itself and imports all of them to print its
help; so at the top they import the standard library only, and the rest inside ``run``.
"""
