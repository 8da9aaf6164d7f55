"""A server's TLS certificate for tests, made by openssl; where there is none the test is skipped."""

import ssl
import subprocess
from pathlib import Path
from shutil import which

import pytest


def certificate(folder: Path) -> tuple[ssl.SSLContext, Path]:
    """Return a server's context and the file that a client checks it with."""
    openssl = which("openssl")
    if openssl is None:
        pytest.skip("openssl, which makes the certificate for this test, is not on this machine")
    key, file = folder / "key.pem", folder / "caster.pem"
    command = [openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
    command += ["-keyout", str(key), "-out", str(file), "-days", "2", "-subj", "/CN=localhost"]
    command += ["-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1"]
    subprocess.run(command, check=True, capture_output=True)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(file, key)
    return context, file
