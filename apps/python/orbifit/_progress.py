"""A bar for ``progress=True``."""

from typing import Any, Callable, Optional


def bar(wanted: bool) -> Optional[Callable[[str, float], None]]:
    """What tells tqdm how far a call is; None where that is not wanted or tqdm is not installed."""
    if not wanted:
        return None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    shown: Any = tqdm(total=1.0, bar_format="{desc} {percentage:3.0f}%|{bar}| {elapsed}", leave=False)

    def tell(stage: str, fraction: float) -> None:
        shown.set_description_str(stage, refresh=False)
        shown.n = fraction
        shown.refresh()

    return tell
