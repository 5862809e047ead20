"use strict";
(() => {
  const root = document.documentElement, body = document.body;
  const slides = [...document.querySelectorAll(".slide")];
  const by = (id) => document.getElementById(id);
  const views = [...document.querySelectorAll("[data-view]")].filter((b) => b.tagName === "BUTTON");
  let now = 0;
  root.classList.add("js");
  by("bar").hidden = false;

  // The address: #NAME, and /VIEW where it is not the usual one.
  const read = () => {
    const [name, view] = decodeURIComponent(location.hash.slice(1)).split("/");
    const found = slides.findIndex((s) => s.id === name);
    if (view && views.some((b) => b.dataset.view === view)) body.dataset.view = view;
    return Math.max(found, 0);
  };
  const write = () => {
    const view = body.dataset.view === "all" ? "" : "/" + body.dataset.view;
    const hash = "#" + slides[now].id + view;
    if (location.hash !== hash) history.replaceState(null, "", hash);
  };
  const show = (index, focus) => {
    now = Math.min(Math.max(index, 0), slides.length - 1);
    slides.forEach((s, i) => s.classList.toggle("now", i === now));
    slides[now].scrollTop = 0;
    by("place").textContent = now ? now + " / " + (slides.length - 1) : "start";
    by("back").disabled = now === 0;
    by("next").disabled = now === slides.length - 1;
    if (focus) {
      by("spoken").textContent = slides[now].getAttribute("aria-label");
      slides[now].querySelector("h1, h2").focus({ preventScroll: true });
    }
    write();
    fit();
  };
  const look = (view) => {
    body.dataset.view = view;
    views.forEach((b) => b.setAttribute("aria-pressed", String(b.dataset.view === view)));
    write();
    fit();
  };
  // One picture alone is as large as its place allows; side by side the style sheet knows.
  const fit = () => {
    const place = slides[now].querySelector(".pictures");
    if (!place) return;
    for (const img of place.querySelectorAll("img")) img.style.width = "";
    if (body.dataset.view === "all") return;
    for (const figure of place.querySelectorAll("figure")) {
      const img = figure.querySelector("img");
      if (!figure.offsetParent) continue;
      let other = 0;
      for (const part of figure.children) {
        if (part !== img) other += part.offsetHeight + parseFloat(getComputedStyle(part).marginTop);
      }
      const height = Math.max(place.clientHeight - other, 80);
      img.style.width = Math.min(place.clientWidth, (height * img.naturalWidth) / img.naturalHeight) + "px";
    }
  };
  const notes = () => {
    const on = root.classList.toggle("with-notes");
    by("notes").setAttribute("aria-pressed", String(on));
  };
  const theme = () => {
    const dark = root.dataset.theme
      ? root.dataset.theme === "dark"
      : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = dark ? "light" : "dark";
  };
  const full = () => {
    const done = document.fullscreenElement ? document.exitFullscreen() : root.requestFullscreen?.();
    done?.catch(() => {});
  };
  const go = (step) => show(now + step, true);

  const keys = {
    ArrowRight: () => go(1), ArrowDown: () => go(1), PageDown: () => go(1), " ": () => go(1),
    ArrowLeft: () => go(-1), ArrowUp: () => go(-1), PageUp: () => go(-1),
    Home: () => show(0, true), End: () => show(slides.length - 1, true),
    0: () => look("all"), 1: () => look("raster"), 2: () => look("trace"), 3: () => look("difference"),
    w: () => look("wipe"), n: notes, l: theme, f: full,
  };
  addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const at = e.target;
    // A slider has its own arrows, a button its own space.
    if (at.tagName === "INPUT" && /^(Arrow|Page|Home|End)/.test(e.key)) return;
    if (e.key === " " && (at.tagName === "BUTTON" || at.tagName === "A")) return;
    const back = e.key === " " && e.shiftKey;
    const action = back ? () => go(-1) : keys[e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (action) {
      e.preventDefault();
      action();
    }
  });
  by("back").onclick = () => go(-1);
  by("next").onclick = () => go(1);
  by("notes").onclick = notes;
  by("theme").onclick = theme;
  by("full").onclick = full;
  by("wipe").oninput = (e) => body.style.setProperty("--wipe", e.target.value + "%");
  views.forEach((b) => (b.onclick = () => look(b.dataset.view)));

  // A click on a picture shows it alone and back; anywhere else it turns the page: left quarter back, rest on.
  document.querySelector("main").addEventListener("click", (e) => {
    if (e.target.closest("a, button, aside") || String(getSelection())) return;
    const figure = e.target.closest("figure");
    if (figure) {
      look(body.dataset.view === "all" ? figure.classList[0] : "all");
    } else if (now > 0) {
      go(e.clientX < innerWidth / 4 ? -1 : 1);
    }
  });
  let touch = null;
  addEventListener("touchstart", (e) => (touch = e.touches.length === 1 ? e.touches[0] : null), { passive: true });
  addEventListener("touchend", (e) => {
    if (!touch || e.target.tagName === "INPUT") return;
    const dx = e.changedTouches[0].clientX - touch.clientX, dy = e.changedTouches[0].clientY - touch.clientY;
    if (Math.abs(dx) > 50 && Math.abs(dx) > 2 * Math.abs(dy)) go(dx < 0 ? 1 : -1);
    touch = null;
  });
  addEventListener("hashchange", () => {
    const index = read();
    look(body.dataset.view);
    show(index, true);
  });
  addEventListener("resize", fit);
  // On paper all three pictures stand side by side, in the light.
  let before = [];
  addEventListener("beforeprint", () => {
    before = [body.dataset.view, root.dataset.theme];
    root.dataset.theme = "light";
    look("all");
  });
  addEventListener("afterprint", () => {
    if (before[1]) root.dataset.theme = before[1];
    else delete root.dataset.theme;
    look(before[0]);
  });
  now = read();
  look(body.dataset.view);
  show(now, false);
})();
