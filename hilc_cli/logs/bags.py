"""Opens bags of ROS 2 that may come from anybody: files that stay inside the bag, bounded sizes.

`rosbags` reads the files and decodes the messages. What it would trust is decided here: which files
belong to a bag, how large anything may become that is decompressed, and that message types are
those of ROS instead of those that a bag describes, of which it would make code.
"""

from __future__ import annotations

import hashlib
import os
import sqlite3
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any, BinaryIO

from hilc_cli.errors import FileAccessError, HilcError, UsageError, needed
from hilc_cli.files import open_to_read, reading, reason
from hilc_cli.wording import counted, listed, printable, shortened
from hilc_cli.yaml_input.nodes import Source, to_data
from hilc_cli.yaml_input.tree import MAX_BYTES, parse_yaml

METADATA = "metadata.yaml"
ENDINGS = (".mcap", ".db3")
_COMPRESSED = ".zstd"
_LARGEST_FILE = 100_000_000_000  # [bytes]
_LARGEST_CHUNK = 256_000_000  # [bytes], decompressed
_LARGEST_UNPACKED = 8_000_000_000  # [bytes], of a file that is compressed as a whole
_LARGEST_MESSAGE = 20_000_000  # [bytes]: poses and commands take hundreds
MOST_MESSAGES = 2_000_000
_MOST_FILES = 1_000
_PIECE = 1_000_000
_FOR_ADDRESSES = frozenset("%?#")
"""Characters of a path that mean something else where SQLite opens it as an address."""


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of a bag.

    Attributes:
        name: Such as ``/cmd_vel``.
        type: Such as ``geometry_msgs/msg/TwistStamped``.
        count: How many messages it has.
    """

    name: str
    type: str
    count: int


class Bag:
    """A bag that is open.

    Attributes:
        path: As the user gave it.
        topics: By name.
    """

    def __init__(self, path: Path, readers: Sequence[Any], *, packed: bool) -> None:
        """Takes over readers of the storage files, in their order."""
        self.path = path
        self._readers = readers
        self._packed = packed
        self.topics = self._found_topics()

    def _found_topics(self) -> dict[str, Topic]:
        topics: dict[str, Topic] = {}
        for reader in self._readers:
            for connection in reader.connections:
                name, kind = str(connection.topic), str(connection.msgtype)
                known = topics.get(name)
                if known is not None and known.type != kind:
                    raise UsageError(
                        f"{self.path}: the topic {shown(name)} has messages of two types; "
                        "record it anew"
                    )
                count = int(connection.msgcount) + (known.count if known else 0)
                topics[name] = Topic(name, kind, count)
        return topics

    def messages(self, topics: Sequence[str]) -> Iterator[tuple[str, int, Any]]:
        """Streams the messages of some topics.

        Args:
            topics: Names, each of which the bag has.

        Yields:
            Topic, time of arrival [ns], and the decoded message.

        Raises:
            UsageError: There are too many, or one cannot be decoded.
        """
        with _readable(self.path):
            yield from self._decoded(topics)

    def _decoded(self, topics: Sequence[str]) -> Iterator[tuple[str, int, Any]]:
        store = _message_types()
        count = 0
        for reader in self._readers:
            wanted = [each for each in reader.connections if each.topic in topics]
            if not wanted:  # to rosbags, no connection means all
                continue
            for connection, arrival, data in reader.messages(wanted):
                count += 1
                if count > MOST_MESSAGES:
                    raise UsageError(
                        f"{self.path}: has more than {MOST_MESSAGES} messages of "
                        f"{listed(map(shown, topics))}; cut out the pass"
                    )
                content = unpacked(data, _LARGEST_MESSAGE) if self._packed else bytes(data)
                if len(content) > _LARGEST_MESSAGE:
                    raise UsageError(
                        f"{self.path}: has a message of {len(content)} bytes on "
                        f"{shown(connection.topic)}; poses and commands are shorter"
                    )
                try:
                    message = store.deserialize_cdr(content, connection.msgtype)
                except Exception as error:  # whatever a generated decoder stumbles over
                    raise UsageError(
                        f"{self.path}: message {count} of {shown(connection.topic)} is damaged: "
                        f"it is no {shown(connection.msgtype)}"
                    ) from error
                yield str(connection.topic), int(arrival), message


def shown(name: str) -> str:
    """A name of a stranger's, for a message."""
    return shortened(printable(name), 80)


def _message_types() -> Any:
    """The message types of ROS 2 that hilc reads; no code is made of what a bag says."""
    typesys = needed("a bag of ROS 2", "rosbags.typesys", "ros")
    return typesys.get_typestore(typesys.Stores.LATEST)


@contextmanager
def opened_bag(path: Path) -> Iterator[Bag]:
    """Opens a bag: its folder, or one of its files.

    Raises:
        UsageError: It is no bag, or one that cannot be read.
        MissingPackageError: There is no ``rosbags``.
        FileAccessError: The system refused.
    """
    storage = needed("a bag of ROS 2", "rosbags.rosbag2", "ros")
    _bound_decompression()
    with ExitStack() as stack:
        files, packed = _files_of(path)
        readers = []
        with _readable(path):
            for file in files:
                place = stack.enter_context(_unpacked_file(path, file))
                if place.suffix == ".db3":
                    _check_database(path, place)
                readers.append(stack.enter_context(storage.Reader(place)))
            bag = Bag(path, readers, packed=packed)
        yield bag


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    """Turns whatever a reader stumbles over in a damaged bag into one line."""
    try:
        yield
    except HilcError:
        raise
    except OSError as error:
        raise FileAccessError(f"{path}: cannot be read: {reason(error)}") from error
    except Exception as error:
        raise UsageError(
            f"{path}: is damaged or no bag of ROS 2: {told(error)}; try 'ros2 bag reindex'"
        ) from error


def told(error: Exception) -> str:
    """What a library says of a failure, in short."""
    return shortened(printable(str(error).rstrip(".") or type(error).__name__), 120)


def checksum_of(path: Path) -> str:
    """Returns the SHA-256 of the files of a bag, one behind the other."""
    digest = hashlib.sha256()
    files, _ = _files_of(path)
    own = [path / METADATA] if path.is_dir() and (path / METADATA).exists() else []
    for file in [*own, *files]:
        with _opened(file) as stream:
            while piece := stream.read(_PIECE):
                digest.update(piece)
    return digest.hexdigest()


def _files_of(path: Path) -> tuple[list[Path], bool]:
    """The storage files of a bag in their order, and whether each message is compressed."""
    _check_path(path, path)
    with reading(path):
        if not path.is_dir():
            return [path], False
        if (path / METADATA).exists():
            return _files_by_metadata(path)
        entries = sorted(path.iterdir())
    files = [entry for entry in entries if entry.suffix in ENDINGS]
    if not files:
        raise UsageError(
            f"{path}: is no bag: it holds no {METADATA} and no {' or '.join(ENDINGS)} file"
        )
    if len(files) > 1:
        raise UsageError(
            f"{path}: has {counted(len(files), 'storage file')} and no {METADATA} that tells "
            "their order; try 'ros2 bag reindex'"
        )
    return [_inside(path, files[0].name)], False


def _files_by_metadata(path: Path) -> tuple[list[Path], bool]:
    place = path / METADATA
    with _opened(place) as stream:
        content = stream.read(MAX_BYTES + 1)
    try:
        whole = to_data(parse_yaml(content, Source(str(place), path), show=False))
        told_by = whole["rosbag2_bagfile_information"]  # type: ignore[index]
        kind, names = told_by["storage_identifier"], list(told_by["relative_file_paths"])
        mode = str(told_by.get("compression_mode") or "").lower()
        form = str(told_by.get("compression_format") or "").lower()
    except (HilcError, TypeError, KeyError, AttributeError) as error:
        raise UsageError(
            f"{place}: is no metadata of a bag: {told(error)}; try 'ros2 bag reindex'"
        ) from error
    if kind not in ("sqlite3", "mcap"):
        raise UsageError(f"{place}: has a storage of a kind that is not read; sqlite3 and mcap are")
    if mode in ("file", "message") and form != "zstd":
        raise UsageError(f"{place}: has a compression that is not read; zstd is")
    if not names or len(names) > _MOST_FILES or not all(isinstance(each, str) for each in names):
        raise UsageError(f"{place}: names no storage files; try 'ros2 bag reindex'")
    return [_inside(path, name) for name in names], mode == "message"


def _inside(folder: Path, name: str) -> Path:
    """A file that a bag names, which must be in its folder.

    Old bags name files with their folder in front.

    Raises:
        UsageError: It leads elsewhere, or there is none.
    """
    own = PurePath(name)
    file = folder / own.name
    outside = UsageError(f"{folder}: names a file outside of the bag; nothing is read from there")
    if own.is_absolute() or own.name in ("", ".", "..") or ".." in own.parts:
        raise outside
    _check_path(folder, file)
    with reading(file):
        if file.is_symlink() and file.resolve().parent != folder.resolve():
            raise outside
        if not file.exists():
            raise UsageError(
                f"{folder}: has no file {shown(own.name)}, which its {METADATA} names; copy the "
                "whole folder"
            )
    if not any(file.name.endswith((end, end + _COMPRESSED)) for end in ENDINGS):
        raise UsageError(f"{folder}: names a file that is no {' or '.join(ENDINGS)} file")
    return file


def _check_path(where: Path, file: Path) -> None:
    if not _FOR_ADDRESSES.isdisjoint(str(file)):
        raise UsageError(f"{where}: has %, ? or # in its path, which no bag can have; rename it")


@contextmanager
def _opened(file: Path) -> Iterator[BinaryIO]:
    with reading(file), os.fdopen(open_to_read(file, _LARGEST_FILE), "rb") as stream:
        yield stream


@contextmanager
def _unpacked_file(bag: Path, file: Path) -> Iterator[Path]:
    """The file itself, or what it holds if it is compressed as a whole, for as long as it takes."""
    with _opened(file):
        pass  # it is a regular file that can be read
    if file.suffix != _COMPRESSED:
        yield file
        return
    zstd = _zstd()
    with tempfile.TemporaryDirectory(prefix="hilc-") as folder:
        place = Path(folder) / file.stem
        size = 0
        with _opened(file) as packed, zstd.open(packed, "rb") as stream, place.open("wb") as out:
            while piece := stream.read(_PIECE):
                size += len(piece)
                if size > _LARGEST_UNPACKED:
                    raise UsageError(
                        f"{bag}: becomes larger than {_LARGEST_UNPACKED} bytes when it is "
                        "decompressed; cut out the pass"
                    )
                out.write(piece)
        yield place


def _zstd() -> Any:
    """The module by which `rosbags` decompresses."""
    return needed("a bag of ROS 2", "rosbags.rosbag2.storage_mcap", "ros").zstd


def unpacked(data: bytes, most: int) -> bytes:
    """Decompresses Zstandard data of bounded size.

    Raises:
        UsageError: It would become larger.
    """
    return _bounded(_zstd().ZstdDecompressor(), bytes(data), most)


def _bounded(decompressor: Any, data: bytes, most: int) -> bytes:
    content: bytes = decompressor.decompress(data, max_length=most + 1)
    if len(content) > most:
        raise UsageError(f"a part of the bag becomes larger than {most} bytes; record it anew")
    return content


def _bound_decompression() -> None:
    """Gives `rosbags` decompressors of chunks that stop at the size that a chunk says it has."""
    mcap = needed("a bag of ROS 2", "rosbags.rosbag2.storage_mcap", "ros")
    frame = needed("a bag of ROS 2", "lz4.frame", "ros")

    def bounded(make: Callable[[], Any]) -> Callable[[bytes, int], bytes]:
        def decompress(data: bytes, size: int) -> bytes:
            return _bounded(make(), bytes(data), min(size, _LARGEST_CHUNK))

        return decompress

    own: Mapping[str, Callable[[bytes, int], bytes]] = {
        "lz4": bounded(frame.LZ4FrameDecompressor),
        "zstd": bounded(mcap.zstd.ZstdDecompressor),
    }
    mcap.DECOMPRESSORS.update(own)


def _check_database(bag: Path, file: Path) -> None:
    """Makes sure that a database holds plain tables, in which nothing is computed as it is read.

    Raises:
        UsageError: It holds views, triggers, virtual tables or computed columns, or is damaged.
    """
    address = f"file:{file.absolute()}?immutable=1&mode=ro"
    try:
        with closing(sqlite3.connect(address, uri=True)) as database:
            rows = database.execute("SELECT type, sql FROM sqlite_master LIMIT 1000").fetchall()
    except sqlite3.Error as error:
        raise UsageError(f"{bag}: is damaged: {told(error)}; try 'ros2 bag reindex'") from error
    for kind, sql in rows:
        text = str(sql or "").lower()
        computes = "virtual" in text or "generated" in text or " as (" in text
        if kind not in ("table", "index") or computes:
            raise UsageError(f"{bag}: has more than plain tables in it; nothing is read from it")
