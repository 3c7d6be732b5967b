"""Checks of the 3D view of a report: drawing and camera control."""

from __future__ import annotations

from chromium import Browser
from pages import FIXTURES, SCENE, Pages, desk


def view_can_be_turned(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("appendix-b"))
    before = browser.run(SCENE)
    box = browser.box("#scene")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    browser.drag([(x, y), (x + 60, y + 10), (x + 120, y + 30)])
    assert browser.run(SCENE) != before
    browser.click("#look")
    assert browser.run(SCENE) == before
    browser.run("document.getElementById('scene').focus()")
    browser.key("ArrowLeft")
    assert browser.run(SCENE) != before


def view_is_seen_from_all_sides(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"), "#t=2")
    usual = browser.run(SCENE)
    looks = {"1": "#look-front", "2": "#look-side", "3": "#look-top", "0": "#look"}
    seen = {}
    for key, button in looks.items():
        browser.click(button)
        seen[button] = browser.run(SCENE)
        pages.keep(browser, f"ten-motions-{button.strip('#')}", whole=False)
        browser.drag([(400, 400), (420, 410)])
        browser.run("document.getElementById('scene').focus()")
        browser.key(key)
        assert browser.run(SCENE) == seen[button], f"{key} is not {button}"
    assert len(set(seen.values())) == 4, "two looks are the same"
    assert seen["#look"] == usual


def view_is_shifted(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"), "#t=2")
    usual = browser.run(SCENE)
    box = browser.box("#scene")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    way = [(x, y), (x + 30, y + 10), (x + 60, y + 20)]
    ways = [lambda: browser.drag(way, button="right"), lambda: browser.drag(way, shift=True)]
    seen = []
    for shift in ways:
        shift()
        seen.append(browser.run(SCENE))
        browser.click("#look")
    assert seen[0] == seen[1] != usual
    browser.run("document.getElementById('scene').focus()")
    browser.key("ArrowUp", shift=True)
    assert browser.run(SCENE) not in (usual, *seen)
    browser.key("0")
    assert browser.run(SCENE) == usual
    # Two fingers at a constant distance shift the view, others zoom.
    browser.size(390, 844, phone=True)
    browser.call("Emulation.setTouchEmulationEnabled", enabled=True)
    usual = browser.run(SCENE)
    box = browser.box("#scene")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    moved = [[(x - 40 + k, y) for k in (0, 15, 30)], [(x + 40 + k, y) for k in (0, 15, 30)]]
    browser.fingers(moved)
    shifted = browser.run(SCENE)
    assert shifted != usual
    assert browser.run("scene.state()[0].nearer") == 1
    browser.fingers([[(x - k, y) for k in (40, 50, 60)], [(x + k, y) for k in (40, 50, 60)]])
    assert abs(browser.run("scene.state()[0].nearer") - 1.5) < 0.01
    browser.call("Emulation.setTouchEmulationEnabled", enabled=False)


def wheel_is_the_pages_until_the_view_is_clicked(browser: Browser, pages: Pages) -> None:
    browser.size(1280, 500)
    browser.open(pages.page("ten-motions"), "#t=2")
    usual = browser.run(SCENE)
    box = browser.box("#scene")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    # The wheel over the view scrolls the page, and a hint explains how to zoom.
    at = browser.run("scrollY")
    browser.wheel(x, y, 60)
    browser.until(f"scrollY > {at}")
    assert browser.run(SCENE) == usual
    assert not browser.run("document.getElementById('hint').hidden")
    box = browser.box("#scene")
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    browser.press(x, y)
    at = browser.run("scrollY")
    browser.wheel(x, y, -120)
    browser.until("scene.state()[0].nearer > 1.1")
    assert browser.run(SCENE) != usual
    assert browser.run("scrollY") == at
    assert browser.run("document.getElementById('hint').hidden")


def view_fills_the_screen(browser: Browser, pages: Pages) -> None:
    desk(browser)
    browser.open(pages.page("ten-motions"), "#t=2")
    before = browser.box("#scene")["height"]
    browser.click("#look-full")
    browser.until("document.fullscreenElement === document.querySelector('.view')")
    browser.until(f"document.getElementById('scene').clientHeight > {before}")
    browser.until(
        "document.getElementById('scene').height === document.getElementById('scene').clientHeight"
    )
    pages.keep(browser, "ten-motions-full", whole=False)
    browser.click("#look-full")
    browser.until("!document.fullscreenElement")


def view_takes_in_the_arm_and_its_way(browser: Browser, pages: Pages) -> None:
    """Robot and path are not cut off and fill most of the view, from each side, wide and narrow."""
    for width in (1280, 390):
        browser.size(width, 844)
        for name in ("ten-motions", "scene"):
            browser.open(pages.page(name), "#t=2")
            for look in ("usual", "front", "side", "top"):
                script = f"""(() => {{
                    scene.look("{look}");
                    drawScene();
                    const {{ matrix }} = scene.camera();
                    const points = ways().flatMap(({{ places, joints }}) => [...places, ...joints]);
                    return points.map(([x, y, z]) => {{
                        const at = [0, 1, 3].map(i => {{
                            const [a, b, c, d] = [0, 4, 8, 12].map(k => matrix[k + i]);
                            return a * x + b * y + c * z + d;
                        }});
                        return [at[0] / at[2], at[1] / at[2]];
                    }});
                }})()"""
                points = browser.run(script)
                most = [max(abs(point[i]) for point in points) for i in (0, 1)]
                assert max(most) < 1, f"{name} from {look}, {width} px: {most}"
                assert name == "scene" or max(most) > 0.6, f"{name} from {look}, {width} px: {most}"


def picture_gets_sharp_at_rest(browser: Browser, pages: Pages) -> None:
    """On a slow machine, the resolution is reduced in motion, and full once at rest."""
    desk(browser)
    browser.open(pages.page("ten-motions"))
    script = """(() => {
        const canvas = document.getElementById("scene");
        const widths = [];
        const at = (turn, now) => {
            scene.follow([{ q: [turn, 0.5, 0, -1.2, 0, 1, 0], ghost: null }], null, now);
            widths.push(canvas.width / canvas.clientWidth);
        };
        scene.sharpen(0.5);
        at(0, 0);
        at(0.1, 20);
        // It trembles, but stands.
        at(0.10001, 100);
        at(0.1, 400);
        at(0.2, 420);
        scene.sharpen(1);
        return widths;
    })()"""
    assert browser.run(script) == [0.5, 0.5, 0.5, 1, 0.5]


def meshes_of_a_urdf_are_drawn(browser: Browser, pages: Pages) -> str:
    """Meshes of an LBR iiwa 14 R820 from another project, whose links are blue, orange and grey."""
    program = str(FIXTURES / "ten-motions.json")
    pages.iiwasim("plan", program, "--robot", "lbr_iiwa_14_r820", "-o", "meshes.mcap")
    pages.iiwasim("report", "meshes.mcap", "-o", "shells.html")
    pages.iiwasim("report", "meshes.mcap", "--urdf", str(pages.urdf), "-o", "meshes.html")
    desk(browser)
    looks = []
    for name in ("shells", "meshes"):
        browser.open(pages.page(name), "#t=2")
        pages.keep(browser, name, whole=False)
        looks.append(browser.run(SCENE))
    assert looks[0] != looks[1]
    links = browser.run("robot.look.links.map(it => it.map(({ paint }) => paint.join()))")
    assert len(links) == 8 and all(len(link) >= 1 for link in links), links
    assert links[1] == ["128,179,255"] and links[3] == ["255,108,10"], links
    count = browser.run("unpackLook(robot.look).triangles.length / 3")
    assert 5000 < count <= 30_000, count
    blue = browser.run("""(() => {
        const flat = document.createElement("canvas");
        const scene = document.getElementById("scene");
        [flat.width, flat.height] = [scene.width, scene.height];
        drawScene();
        flat.getContext("2d").drawImage(scene, 0, 0);
        const { data } = flat.getContext("2d").getImageData(0, 0, flat.width, flat.height);
        let blue = 0;
        for (let i = 0; i < data.length; i += 4) {
            if (data[i + 2] > 1.3 * data[i] && data[i] > 60) blue++;
        }
        return blue;
    })()""")
    assert blue > 2000, blue
    # Normals have unit length, and match the triangles, except at creases.
    along = browser.run("""(() => {
        const { floats, triangles } = unpackLook(robot.look);
        let sum = 0;
        for (let i = 0; i < triangles.length; i += 3) {
            const [a, b, c] = [0, 1, 2].map(k => {
                const first = 10 * triangles[i + k];
                return floats.subarray(first, first + 6);
            });
            const [u, v] = [b, c].map(p => [0, 1, 2].map(k => p[k] - a[k]));
            const n = [[1, 2], [2, 0], [0, 1]].map(([j, k]) => u[j] * v[k] - u[k] * v[j]);
            sum += (n[0] * a[3] + n[1] * a[4] + n[2] * a[5]) / (Math.hypot(...n) || 1);
        }
        return sum / (triangles.length / 3);
    })()""")
    assert along > 0.9, along
    size = pages.page("meshes").stat().st_size
    assert size < 2_000_000, size
    return f"page of ten motions with meshes of {count:.0f} triangles {size / 1e6:.2f} MB"


VIEW_CHECKS = [
    view_can_be_turned,
    view_is_seen_from_all_sides,
    view_is_shifted,
    wheel_is_the_pages_until_the_view_is_clicked,
    view_fills_the_screen,
    view_takes_in_the_arm_and_its_way,
    picture_gets_sharp_at_rest,
]
