"""Makes links of the navigation relative: to the API reference, and to pages that another section has too."""
from mkdocs.structure.nav import Link


def on_nav(nav, **_):
    def relative(items):
        for item in items:
            if isinstance(item, Link):
                item.url = item.url.lstrip("/")
            relative(item.children or [])
    relative(nav.items)
    return nav
