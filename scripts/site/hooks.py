"""Makes links of the navigation relative: those to the API reference, and to pages that another section also lists."""
from mkdocs.structure.nav import Link


def on_nav(nav, **_):
    def relative(items):
        for item in items:
            if isinstance(item, Link):
                item.url = item.url.lstrip("/")
            relative(item.children or [])
    relative(nav.items)
    return nav
