#!/usr/bin/python3
"""Steps of scripts/docs besides Doxygen and MkDocs.

    site.py doxygen WORK     writes Doxygen's other inputs: modules, examples
    site.py examples WORK    links public types to examples; fails for a type without one
    site.py pages WORK       prepares the documents for MkDocs, with links into the reference
    site.py finish WORK SITE adds the reference to the search; fails for broken links and for files loaded from other machines
"""
import collections
import html.parser
import json
import os
import pathlib
import re
import subprocess
import sys
import urllib.parse
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
PUBLIC_HEADER = re.compile(r"osteomill/\w+/include/(osteomill/.+\.h)")
EXAMPLES = [path for path in sorted(ROOT.glob("examples/*.cpp")) if "#include <osteomill/" in path.read_text()]
CODE = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.S)
LANGUAGES = {".c": "c", ".cpp": "cpp", ".py": "python", ".toml": "toml", ".cff": "yaml"}


def headers():
    """Returns the installed headers listed in the CMakeLists.txt of the modules."""
    return [module.parent / line for module in sorted(ROOT.glob("osteomill/*/CMakeLists.txt"))
            for line in re.findall(r"^\s*(include/osteomill/\S+\.h)$", module.read_text(), re.M)]


def code_of_page(page):
    return "\n".join(re.findall(r"^```cpp\n(.*?)^```", page.read_text(), re.M | re.S))


def doxygen(work):
    """Writes WORK/modules.dox, WORK/Doxyfile and the C++ code of the documents as examples."""
    architecture = (ROOT / "docs/architecture.md").read_text()
    modules = [(module, purpose[0].upper() + purpose[1:]) for module, purpose in
             re.findall(r"^### `(\w+)`.*?\n- \*\*Purpose\*\*: (.*?)(?=\n- \*\*)", architecture, re.M | re.S)]
    text = ["@mainpage API reference",
            "The public headers, by module ([architecture](../docs/architecture.html#the-modules)); a module is a component of the",
            "installed package ([how to link it](../docs/library.html#link)). Units, frames and errors follow the",
            "[conventions](../docs/conventions.html).", "", "| module | purpose |", "|---|---|"]
    text += [f"| @ref {module} | {' '.join(purpose.split())} |" for module, purpose in modules]
    text += ["", "Members without a comment are explained by their name and unit. Complete programs: [examples](examples.html)."]
    blocks = [f"/**\n{chr(10).join(text)}\n*/"]
    blocks += [f"/** @defgroup {module} {module}\n{purpose}\n*/" for module, purpose in modules]
    example_folder = work / "examples"
    example_folder.mkdir()
    for page in sorted(ROOT.glob("docs/*.md")):
        if code := code_of_page(page):
            (example_folder / f"{page.stem}.cpp").write_text(code)
            blocks.append(f"/** @example {page.stem}.cpp\nThe C++ of [{page.name}](../docs/{page.stem}.html). */")
    blocks += [f"/** @example {path.name} */" for path in EXAMPLES]
    (work / "modules.dox").write_text("\n".join(blocks))
    settings = [(ROOT / "scripts/site/Doxyfile").read_text(), f"OUTPUT_DIRECTORY = {work}", f"INPUT = {work}/modules.dox",
                f"EXAMPLE_PATH = examples {example_folder} .", f"WARN_LOGFILE = {work}/doxygen.log",
                'FILTER_PATTERNS = "*.h=awk -f scripts/site/module_of_header.awk"', f"HTML_HEADER = {work}/header.html", f"LAYOUT_FILE = {work}/layout.xml"]
    settings += [f"INPUT += {header.relative_to(ROOT)}" for header in headers()]
    for module in sorted(ROOT.glob("osteomill/*/include")):
        settings += [f"STRIP_FROM_PATH += {module}", f"STRIP_FROM_INC_PATH += {module}"]
    (work / "Doxyfile").write_text("\n".join(settings) + "\n")


class Entity:
    """An entity of the reference: its name, page and first sentence, the links in its comment, and the types in its declaration."""

    def __init__(self, node, name, kind, outer=None):
        self.id, self.name, self.kind, self.outer = node.get("id"), name, kind, outer
        page, _, anchor = (self.id, "", "") if outer is None and node.tag == "compounddef" else self.id.rpartition("_1")
        self.url = f"api/{page}.html" + (f"#{anchor}" if anchor else "")
        comments = [node.find(part) for part in ("briefdescription", "detaileddescription")]
        self.brief = " ".join("".join(comments[0].itertext()).split())
        self.links = {ref.get("refid") for comment in comments if comment is not None for ref in comment.iter("ref")}
        self.signature = {ref.get("refid") for part in ("type", "param") for found in node.findall(part)
                          for ref in found.iter("ref")}
        self.header = node.find("location").get("file") if node.find("location") is not None else ""


def reference(work):
    """Returns all public entities, and the ids used in examples."""
    entities, shown = [], set()
    for path in sorted((work / "xml").glob("*.xml")):
        compound = ElementTree.parse(path).getroot().find("compounddef")
        if compound is None or compound.get("prot") == "private":
            continue
        kind, name = compound.get("kind"), compound.findtext("compoundname")
        if kind == "example":
            shown |= {ref.get("refid") for ref in compound.iter("ref")}
        elif kind == "file" and name.endswith(".h"):
            entities.append(Entity(compound, compound.find("location").get("file"), kind))
        elif kind in ("class", "struct", "group"):
            outer = Entity(compound, name.replace("osteomill::", ""), kind)
            entities.append(outer)
            scope = "" if kind == "group" else f"{outer.name}::"
            entities += [Entity(member, scope + member.findtext("name"), member.get("kind"), outer)
                         for member in compound.iter("memberdef") if member.get("prot") == "public"]
    return entities, shown


def examples(work):
    """Adds to WORK/modules.dox, for every type that no example uses, a link to compiled code that does: the test of its header, any
    test that names it, the test of an entity that its comment links to, that contains it, or that takes or returns it, or a
    source of the project. Nested types are covered by the enclosing type. Fails for a type without any."""
    entities, shown = reference(work)
    shown |= {entity.outer.id for entity in entities if entity.id in shown and entity.outer and entity.outer.kind != "group"}
    scopes = {entity.name for entity in entities if entity.kind in ("class", "struct")}
    words = {path: collections.Counter(re.findall(r"\w+", CODE.sub("", path.read_text())))
             for path in ROOT.glob("[!b]*/**/*.cpp")}
    tests = [path for path in words if path.stem.endswith("_test")]

    def best_of(entity, paths):
        name, header = entity.name.rpartition("::")[2], pathlib.PurePath(entity.header)
        best = max(paths, key=lambda path: (words[path][name] > 0, path.stem == f"{header.stem}_test", words[path][name],
                                            path.stem))
        return best if words[best][name] > 0 else None

    blocks, used, fine = [], set(), True
    for entity in entities:
        if entity.kind not in ("class", "struct", "enum") or entity.id in shown:
            continue
        if entity.name.rpartition("::")[0] in scopes:
            continue
        users = [one.outer if one.outer and one.outer.kind != "group" else one for one in entities
                 if one.id in entity.links or entity.id in one.signature]
        by = next((one for one in [entity, *users] if one.id in shown or best_of(one, tests)), entity)
        source = None if by.id in shown else best_of(by, tests) or best_of(by, words)
        if by is entity and source is None:
            print(f"{entity.header}: {entity.name} is used in no example, test or source")
            fine = False
            continue
        lines = [f"/** @{entity.kind} osteomill::{entity.name}", "@par Example"]
        if by is not entity:
            lines.append(f"Used with osteomill::{by.name}" + ("()." if by.kind == "function" else "."))
        if source:
            lines.append(f"@ref use_of_{source.stem} \"{source.name}\"")
        blocks.append("\n".join([*lines, "*/"]))
        used |= {source} - {None}
    blocks += [f"/** @page use_of_{path.stem} {path.name}\n`{path.relative_to(ROOT)}`, an example of types that no program in examples/ uses.\n"
               f"@include {path.relative_to(ROOT)} */" for path in sorted(used)]
    with (work / "modules.dox").open("a") as dox:
        dox.write("\n".join(blocks))
    return fine


def linked_names(entities):
    """Returns the page of every name to link in documents: types, functions of two words or more, members, headers."""
    names = {}
    for entity in entities:
        name = entity.name
        if entity.kind in ("class", "struct", "file", "enum", "typedef", "variable") or "::" in name or "_" in name:
            names.setdefault(name, entity.url)
    return names


def as_python_markdown(text):
    """Converts CommonMark lists to the form of MkDocs: after an empty line, and nested by four spaces."""
    lines, in_list, before = [], False, ""
    for line in text.split("\n"):
        item = re.match(r" {0,3}(?:[-*]|(\d+)\.) ", line)
        if item and not in_list and before.strip() and item[1] in (None, "1"):
            lines.append("")
        if item and in_list and line.startswith("  "):
            line = "    " + line.lstrip()
        in_list = bool(item) or in_list and (line.startswith(" ") or line == "" or before != "")
        lines.append(line)
        before = line
    return "\n".join(lines)


def pages(work):
    entities, _ = reference(work)
    names = linked_names(entities)
    to = work / "pages"
    listed = subprocess.check_output(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md", "docs"],
                                     cwd=ROOT, text=True)
    sources = set()

    def write(path, content):
        (to / path).parent.mkdir(parents=True, exist_ok=True)
        (to / path).write_bytes(content)

    def of_link(page, target):
        path, _, anchor = target.partition("#")
        if re.match(r"\w+:|#|$", target) or path.endswith((".md", ".png", ".svg")):
            return target
        file = pathlib.PurePosixPath(os.path.normpath(page.parent / path))
        up = os.path.relpath(".", page.parent)
        if (header := PUBLIC_HEADER.fullmatch(str(file))) and header[1] in names:
            return f"{up}/{names[header[1]]}"
        if ROOT / file in EXAMPLES:
            return f"{up}/api/{file.stem}_8cpp-example.html"
        if not (ROOT / file).is_file():
            sys.exit(f"{page}: {target} is not there")
        sources.add(file)
        return f"{path}.md"

    def of_code(page, text):
        name = re.sub(r"\(\)$|<.*>$", "", text.strip("`")).removeprefix("osteomill::")
        return f"[{text}]({os.path.relpath(names[name], page.parent)})" if name in names else text

    def rewritten(page, text):
        parts = re.split(r"(?ms)(^```.*?^```|^#.*?$)", text)
        pattern = re.compile(r"(!?\[(?:[^\[\]]|\[[^\]]*\])*\])\(([^)\s]+)\)|(`[^`\n]+`)")
        for n in range(0, len(parts), 2):
            parts[n] = pattern.sub(lambda m: of_code(page, m[3]) if m[3] else f"{m[1]}({of_link(page, m[2])})",
                                   as_python_markdown(parts[n]))
        return "".join(parts)

    for name in listed.splitlines():
        page = pathlib.PurePosixPath(name)
        if page.parts[0] not in ("docs", page.name):
            continue
        content = (ROOT / name).read_bytes()
        write(page, rewritten(page, content.decode()).encode() if page.suffix == ".md" else content)
    for file in sources:
        text = (ROOT / file).read_text()
        write(f"{file}.md", f"# {file}\n\n```{LANGUAGES.get(file.suffix, '')}\n{text}\n```\n".encode())
    write("pages.css", (ROOT / "scripts/site/pages.css").read_bytes())
    (work / "mkdocs.yml").write_text(json.dumps({
        "INHERIT": str(ROOT / "scripts/site/mkdocs.yml"), "hooks": [str(ROOT / "scripts/site/hooks.py")],
        "docs_dir": "pages", "site_dir": "../site", "nav": navigation()}))


def navigation():
    """Returns the navigation from docs/README.md; a page that an earlier section lists becomes a link."""
    nav, seen = [{"Home": "README.md"}, {"By reader": "docs/README.md"}], {"README.md", "docs/README.md"}
    for section in re.split(r"^## ", (ROOT / "docs/README.md").read_text(), flags=re.M)[1:]:
        title, _, text = section.partition("\n")
        items = {}
        for name, target in re.findall(r"\[([^\]]+)\]\(([^)#\s]+\.md)[^)]*\)", text):
            path = os.path.normpath(f"docs/{target}")
            if path not in items:
                link = "/" + path.replace("README", "index").removesuffix(".md") + ".html"
                items[path] = {name[0].upper() + name[1:]: link if path in seen else path}
        seen |= items.keys()
        nav.append({title: [*items.values()]})
    return [*nav, {"API": "/api/index.html"}]


class Links(html.parser.HTMLParser):
    """The anchors of a page, its links, and the files it loads."""

    def __init__(self, text):
        super().__init__()
        self.anchors, self.links, self.loaded = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.anchors |= {given[name] for name in ("id", "name") if given.get(name)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        for name in ("src", "data", "href"):
            if tag not in ("a", "meta") and given.get(name):
                self.loaded.append(given[name])


def finish(work, site):
    entities, _ = reference(work)
    index = site / "search/search_index.json"
    search = json.loads(index.read_text())
    # The search needs a page, then its title as the first location on it, then other locations. Members are left out because they
    # would crowd out documents.
    for entity in entities:
        is_page = entity.kind in ("group", "class", "struct")
        if is_page or entity.outer and entity.outer.kind == "group" and entity.kind in ("enum", "function", "typedef"):
            entry = {"location": entity.url, "title": entity.name, "text": entity.brief}
            search["docs"] += [entry, {**entry, "location": entity.url + "#details"}] if is_page else [entry]
    index.write_text(json.dumps(search, separators=(",", ":")))

    (site / "404.html").unlink()  # works only at the root of a server
    found = {path: Links(path.read_text(errors="replace")) for path in site.rglob("*.html")}
    faults = set()
    for path, page in found.items():
        for target in page.links + page.loaded:
            url = urllib.parse.urlsplit(target)
            if url.scheme or url.netloc:
                if target in page.loaded and url.scheme not in ("data", "javascript"):
                    faults.add(f"{path.relative_to(site)}: loads {target}")
                continue
            to = pathlib.Path(os.path.normpath(path.parent / urllib.parse.unquote(url.path))) if url.path else path
            to = to / "index.html" if to.is_dir() else to
            # Doxygen links to private nested classes but does not show them.
            if url.fragment == "nested-classes":
                continue
            if not to.exists():
                faults.add(f"{path.relative_to(site)}: {target} is not there")
            elif url.fragment and to in found and urllib.parse.unquote(url.fragment) not in found[to].anchors:
                faults.add(f"{path.relative_to(site)}: {target} has no such anchor")
    print(*sorted(faults), sep="\n", end="\n" if faults else "")
    print(f"{len(found)} pages, {sum(len(page.links) for page in found.values())} links")
    return not faults


if __name__ == "__main__":
    step = {"doxygen": doxygen, "examples": examples, "pages": pages, "finish": finish}[sys.argv[1]]
    sys.exit(step(*map(pathlib.Path, sys.argv[2:])) is False)
