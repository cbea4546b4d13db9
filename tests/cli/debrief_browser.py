#!/usr/bin/env python3
"""Turns, zooms, picks a bone, presses a mark and plays in a page with bone in 3D, if it has these, with real mouse or touch
events in Chromium.
    debrief_browser.py PAGE WIDTH HEIGHT     as a phone with touch if WIDTH is below 600
    debrief_browser.py PAGE none             in a browser without WebGL
Writes screenshots to $OSTEOMILL_PICTURES if it is set.
"""
import math
import os
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.action_builder import ActionBuilder
from selenium.webdriver.common.actions.pointer_input import PointerInput
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

page, size = os.path.abspath(sys.argv[1]), sys.argv[2:]
name_of_page = os.path.basename(os.path.dirname(page))
has_webgl = size[0] != "none"
wide, high = map(int, size) if has_webgl else (1280, 800)
is_phone = wide < 600
options = Options()
for argument in ["--headless=new", "--no-sandbox", "--hide-scrollbars", f"--window-size={wide},{high}"]:
    options.add_argument(argument)
gl = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] if has_webgl else ["--disable-gpu", "--disable-3d-apis"]
for argument in gl:
    options.add_argument(argument)
if is_phone:
    options.add_experimental_option("mobileEmulation", {"deviceMetrics": {"width": wide, "height": high, "pixelRatio": 2.0, "touch": True}})
options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
browser = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
try:
    if not is_phone:
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {"width": wide, "height": high, "deviceScaleFactor": 1, "mobile": False})
    # The page must not load anything from the network.
    browser.execute_cdp_cmd("Network.enable", {})
    browser.execute_cdp_cmd("Network.emulateNetworkConditions", {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0})
    browser.get("file://" + page)

    def run(script, *arguments):
        return browser.execute_script("const page = window.osteomillPage; " + script, *arguments)

    def show(selector):
        run("document.querySelector(arguments[0]).scrollIntoView({block: 'start'})", selector)
        time.sleep(0.3)

    def picture(name):
        if os.environ.get("OSTEOMILL_PICTURES"):
            browser.save_screenshot(f"{os.environ['OSTEOMILL_PICTURES']}/{name_of_page}-{'x'.join(size)}-{name}.png")

    def eventually(is_true, what, seconds=40):
        """Waits, since a busy machine draws slowly."""
        for _ in range(10 * seconds):
            if is_true():
                return
            time.sleep(0.1)
        raise AssertionError(what)

    assert (run("return innerWidth"), run("return innerHeight")) == (wide, high), (run("return innerWidth"), run("return innerHeight"))
    assert run("return document.documentElement.scrollWidth") <= wide, "the page is wider than the screen"
    picture("top")
    if not has_webgl:
        still = browser.find_element(By.CSS_SELECTOR, "#bone figure img")
        assert still.is_displayed() and run("return arguments[0].naturalWidth", still) > 300
        assert not browser.find_elements(By.CSS_SELECTOR, ".view canvas")
        for button in browser.find_elements(By.CSS_SELECTOR, ".marks button")[:1]:
            button.click()
            assert browser.find_element(By.ID, "card").is_displayed()
        picture("still")
        sys.exit(0)

    show("#bone")
    canvas = browser.find_element(By.CSS_SELECTOR, ".view canvas")
    frame = run("const f = arguments[0].getBoundingClientRect(); return [f.left, f.top, f.width, f.height]", canvas)
    middle = (frame[0] + frame[2] / 2, frame[1] + frame[3] / 2)

    def drag(fingers):
        """Drags one or more fingers, or the mouse, each from one place to another."""
        action = ActionBuilder(browser)
        action.devices = []
        for n, (begin, end) in enumerate(fingers):
            pointer = PointerInput("touch" if is_phone else "mouse", f"pointer{n}")
            action.devices.append(pointer)
            pointer.create_pointer_move(duration=0, x=int(begin[0]), y=int(begin[1]))
            pointer.create_pointer_down(button=0)
            for k in range(1, 6):
                pointer.create_pointer_move(duration=40, x=int(begin[0] + (end[0] - begin[0]) * k / 5), y=int(begin[1] + (end[1] - begin[1]) * k / 5))
            pointer.create_pointer_up(button=0)
        action.perform()
        time.sleep(0.3)

    def camera():
        return run("const c = page.camera; return c.position.toArray().concat(c.quaternion.toArray())")

    def away(place):
        return math.dist(place[:3], run("return JSON.parse(document.getElementById('page-data').textContent).focus"))

    # Turning keeps the distance and changes the direction.
    before, pixels = camera(), canvas.screenshot_as_base64
    picture("begin")
    drag([(middle, (middle[0] + 60, middle[1] + 40))])
    eventually(lambda: math.dist(before[:3], camera()[:3]) > 0.2 * away(before), "it does not turn")
    turned = camera()
    assert abs(away(turned) - away(before)) < 1e-3 * away(before)
    eventually(lambda: canvas.screenshot_as_base64 != pixels, "the picture did not change")
    picture("turned")
    # Zooming in.
    if is_phone:
        drag([((middle[0] - 20, middle[1]), (middle[0] - 90, middle[1])), ((middle[0] + 20, middle[1]), (middle[0] + 90, middle[1]))])
    else:
        for _ in range(4):
            ActionChains(browser).scroll_from_origin(ScrollOrigin.from_element(canvas), 0, -100).perform()
        time.sleep(0.3)
    eventually(lambda: away(camera()) < 0.9 * away(turned), "it does not zoom")
    picture("zoomed")
    # Another bone gives another picture.
    for choice in browser.find_elements(By.ID, "choice"):
        run("arguments[0].scrollIntoView({block: 'center'})", choice)
        picked = Select(choice)
        names = [option.text for option in picked.options]
        assert len(set(names)) == len(names) > 1 and picked.first_selected_option.text == names[-1], names
        seen = set()
        for name in names:
            before = canvas.screenshot_as_base64
            picked.select_by_visible_text(name)
            eventually(lambda: canvas.screenshot_as_base64 not in seen and (name == names[-1] or canvas.screenshot_as_base64 != before), f"{name} looks like another")
            time.sleep(0.3)
            seen.add(canvas.screenshot_as_base64)
            show(".view")
            picture("choice-" + str(names.index(name)))
        show("#bone")
    faults = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not faults, faults
    marks = run("return page.marks")
    if marks is None:
        print("turned, zoomed and picked at", "x".join(size))
        sys.exit(0)
    # Pressing a mark shows its event and jumps to its time.
    assert marks
    chosen = len(marks) - 1
    for _ in range(8):
        x, y, _ = run("return page.pixelOf(arguments[0])", chosen)
        if 5 < x < frame[2] - 5 and 5 < y < frame[3] - 5:
            break
        # Too close; zoom out.
        if is_phone:
            drag([((middle[0] - 90, middle[1]), (middle[0] - 60, middle[1])), ((middle[0] + 90, middle[1]), (middle[0] + 60, middle[1]))])
        else:
            ActionChains(browser).scroll_from_origin(ScrollOrigin.from_element(canvas), 0, 100).perform()
            time.sleep(0.3)
    press = (frame[0] + x, frame[1] + y)
    drag([(press, press)])
    card = browser.find_element(By.ID, "card")
    eventually(card.is_displayed, "no mark was found under the pointer")
    # Marks may overlap.
    titles = [mark["title"] for mark in marks]
    found = titles.index(card.find_element(By.TAG_NAME, "h3").text)
    there = run("return page.pixelOf(arguments[0])", found)
    assert math.dist(there[:2], (x, y)) < 2, (titles[found], there, x, y)
    assert abs(run("return page.time()") - marks[found]["time"]) < 1e-6
    for name, value in marks[found]["facts"]:
        assert name in card.text and value in card.text, (name, value, card.text)
    assert card.find_element(By.TAG_NAME, "input").get_attribute("value") == marks[found]["command"]
    show(".view")
    picture("mark")
    # So does the list of marks.
    button = browser.find_elements(By.CSS_SELECTOR, ".marks button")[0]
    run("arguments[0].scrollIntoView({block: 'center'})", button)
    button.click()
    eventually(lambda: abs(run("return page.time()") - marks[0]["time"]) < 1e-6, "the list does not go to its mark")
    # Playing from the start at two speeds.
    times = {}
    for speed in ("0.1", "0.25"):
        run("const slider = document.getElementById('time'); slider.value = slider.min; slider.dispatchEvent(new Event('input'))")
        Select(browser.find_element(By.ID, "speed")).select_by_value(speed)
        play = browser.find_element(By.ID, "play")
        run("arguments[0].scrollIntoView({block: 'center'})", play)
        play.click()
        eventually(lambda: play.text == "Pause", "it does not play")
        played = []
        for _ in range(200):
            now = run("return page.played()")
            if not played or now[0] > played[-1][0]:
                played.append(now)
            if len(played) > 2:
                break
            time.sleep(0.1)
        # Each frame shows its own time, however slow the frame rate.
        times[speed] = 1000 * (played[-1][0] - played[1][0]) / (played[-1][1] - played[1][1])
        play.click()
        eventually(lambda: play.text == "Play", "it does not stop")
        picture("played")
        still = run("return page.time()")
        time.sleep(0.3)
        assert run("return page.time()") == still
    assert all(abs(rate - float(speed)) < 1e-3 for speed, rate in times.items()), times
    # A press on the progress curve jumps to its time.
    show("#course")
    course = browser.find_element(By.CSS_SELECTOR, "svg.course")
    frame = run("const f = arguments[0].getBoundingClientRect(); return [f.left, f.top, f.width, f.height]", course)
    press = (frame[0] + 48 + 0.5 * (frame[2] - 60), frame[1] + 60)
    drag([(press, press)])
    # The axis ends with the longer of the two recordings.
    span = run("const slider = document.getElementById('time'), first = Osteomill.data.first; return [Number(slider.min), Math.max(Number(slider.max), ...(first ? first.progress.time : []))]")
    eventually(lambda: abs(run("return page.time()") - sum(span) / 2) < 0.01 * (span[1] - span[0]), "the course does not go to its time")
    picture("course")
    faults = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert not faults, faults
    print("turned, zoomed, pressed and played at", "x".join(size))
finally:
    browser.quit()
