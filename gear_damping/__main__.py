"""The one command: `python -m gear_damping`."""


def main() -> None:
    """Run the command line."""


if __name__ == "__main__":
    main()
