"""Policy: what a page of HTML may load and run, which browsers see to: a Content-Security-Policy."""

import base64
import hashlib
import re

_INLINE = re.compile(r'<(script|style)(?: type="module")?>(.*?)</\1>', re.DOTALL)
_NOTHING = "default-src 'none'; base-uri 'none'; form-action 'none'"


def policy(*inline: str, **sources: str) -> str:
    """The policy of a page: the scripts and styles in these texts of HTML, what has these sources, and nothing else.

    sources: of each kind, what a directive such as img-src lists: img="data:".
    """
    allowed = {kind: [listed] for kind, listed in sources.items()}
    for kind, content in (found for text in inline for found in _INLINE.findall(text)):
        digest = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
        allowed.setdefault(kind, []).append(f"'sha256-{digest}'")
    return "; ".join([_NOTHING, *(f"{kind}-src {' '.join(listed)}" for kind, listed in sorted(allowed.items()))])
