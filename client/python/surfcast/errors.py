"""The errors of the client. Their text is the server's sentence where the server refused."""

from __future__ import annotations


class Error(Exception):
    """Any failure of a request or of a connection."""


class NotFound(Error, LookupError):
    """There is no model of that name, or the token does not open it."""


class InvalidInput(Error, ValueError):
    """A value that the server or the client does not accept."""


class Unsupported(Error):
    """The server, or a package that is not installed, would be needed for this."""


class Limit(Error):
    """Larger than a limit of the server."""


class Unavailable(Error):
    """The server is busy, stopping, or still building the model. Worth trying again later."""


class Denied(Error):
    """A token is missing, wrong, revoked or expired."""


class Cancelled(Error):
    """The server cancelled the request, for example because it stops."""


class ServerFault(Error):
    """A fault of the server or of its operating system."""


class ConnectionLost(Error, ConnectionError):
    """There is no connection, or it ended before the answer."""


class VersionMismatch(Error):
    """Client and server speak incompatible versions of the protocol."""


class Timeout(Error, TimeoutError):
    """No answer within the timeout. What can be cancelled on the server has been."""
