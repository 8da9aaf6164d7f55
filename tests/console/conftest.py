"""What tests of the console share: a short simulated run, made once; a browser in front of a drive of stand-ins."""

import pytest
from chromium import open_chromium
from console_browser import drive_with_console, new_page, new_visitor

from drawbar.config import load_configuration
from drawbar.simulation import simulate


@pytest.fixture(scope="session")
def run_log():
    """Return the log of a run along one figure-eight, and its configuration."""
    configuration = load_configuration("articulated", ["path.radii=[4.0]", "path.straight_length=1.0"])
    return simulate(configuration, 1), configuration


@pytest.fixture(scope="module")
def browser():
    with open_chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def drive(browser, tmp_path_factory):
    """Return the address of the console of a drive that is on; none without a browser."""
    with drive_with_console(tmp_path_factory.mktemp("drive")) as address:
        yield address


@pytest.fixture(scope="module")
def visitor(browser):
    """Return what opens pages of one visitor, who keeps control from test to test."""
    context = new_visitor(browser)
    yield context
    context.close()


@pytest.fixture
def somebody_else(browser):
    """Return what opens pages of another visitor."""
    context = new_visitor(browser)
    yield context
    context.close()


@pytest.fixture
def page(visitor):
    opened = new_page(visitor)
    yield opened
    opened.close()
