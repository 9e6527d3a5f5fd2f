from pathlib import Path

FORMAT = "spring-sandbox/replay"
RECORDINGS = (".replay.jsonl", ".replay.gz", ".replay.jsonl.gz")


def is_recording(path: Path) -> bool:
    """Whether a file is called as recordings are; one whose name begins with a point is not whole yet."""
    return path.name.endswith(RECORDINGS) and not path.name.startswith(".")


def stem_of(name: str) -> str:
    """The name of a recording without its endings."""
    for ending in (".gz", ".jsonl", ".replay"):
        name = name.removesuffix(ending)
    return name


def smallest_test(recording: Path) -> Path:
    """The test in Python that lies beside the smallest recording of a failure."""
    words = "".join(each if each.isascii() and each.isalnum() else "_" for each in stem_of(recording.name))
    return recording.with_name(f"test_{words.strip('_').lower()}.py")


def recordings_in(folder: Path) -> list[Path]:
    """The recordings in a folder and those in it, by their paths; hidden folders are left out."""
    found = [path for path in folder.rglob("*") if is_recording(path) and path.is_file()]
    return sorted(path for path in found if not any(part.startswith(".") for part in path.relative_to(folder).parts))
