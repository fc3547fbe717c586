"""What `ajar watch --tev` sends is, byte for byte, what tev's own client sends for the same image."""

import os
import socket
import struct
from pathlib import Path

import numpy as np
import pytest
from watching import SCENE, Watch, studio

packet = pytest.importorskip("tevclient.packet")
WIDTH, HEIGHT = 48, 32


def read(connection: socket.socket) -> bytes:
    """The next packet."""
    head = connection.recv(4, socket.MSG_WAITALL)
    (length,) = struct.unpack("<I", head)
    return head + connection.recv(length - 4, socket.MSG_WAITALL)


pytestmark = pytest.mark.skipif("AJAR_BIN" not in os.environ, reason="AJAR_BIN names no program")


def test_packets_are_those_of_tevclient(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        size = f"{WIDTH}x{HEIGHT}"
        watch = Watch(studio(tmp_path), "--size", size, "--tev", f"127.0.0.1:{port}", "--port", "0", state=tmp_path)
        connection, _ = server.accept()
        with connection:
            create, update = read(connection), read(connection)
        watch.end()
    assert create == packet.create_image("ajar", WIDTH, HEIGHT, ["R", "G", "B"], True)
    pixels = np.frombuffer(update, "<f4", offset=len(update) - WIDTH * HEIGHT * 12).reshape(HEIGHT, WIDTH, 3)
    assert update == packet.update_image("ajar", pixels, ["R", "G", "B"], 0, 0, False)
    assert np.isfinite(pixels).all()
    assert pixels.mean() > 0.01


def test_an_image_of_another_size_takes_the_place_of_the_one_before(tmp_path: Path) -> None:
    scene = studio(tmp_path)

    def resize(width: int, height: int) -> None:
        scene.write_text(SCENE.replace("size = [320, 200]", f"size = [{width}, {height}]"))

    resize(WIDTH, HEIGHT)
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        watch = Watch(scene, "--tev", f"127.0.0.1:{port}", "--port", "0", state=tmp_path)
        connection, _ = server.accept()
        with connection:
            assert read(connection) == packet.create_image("ajar", WIDTH, HEIGHT, ["R", "G", "B"], True)
            resize(HEIGHT, WIDTH)
            close = packet.close_image("ajar")
            while (sent := read(connection))[4] != close[4]:
                pass
            assert sent == close
            assert read(connection) == packet.create_image("ajar", HEIGHT, WIDTH, ["R", "G", "B"], True)
        watch.end()


def test_the_image_of_a_script_arrives(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        tev = f"127.0.0.1:{port}"
        watch = Watch(studio(tmp_path), "--size", f"{WIDTH}x{HEIGHT}", "--once", "--tev", tev, state=tmp_path)
        connection, _ = server.accept()
        with connection:
            sent = connection.makefile("rb").read()
        assert watch.end() == 0
    create = packet.create_image("ajar", WIDTH, HEIGHT, ["R", "G", "B"], True)
    assert sent.startswith(create)
    update = sent[len(create) :]
    assert len(update) >= struct.unpack_from("<I", update)[0] > WIDTH * HEIGHT * 12
