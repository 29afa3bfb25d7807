/** The theme button: light, dark, or that of the system. */

import type { CleaveViewer } from "../component/element";
import { byId } from "./dom";

type Theme = "auto" | "light" | "dark";

const KEPT_AS = "cleave.theme";
const NEXT: Record<Theme, Theme> = { auto: "light", light: "dark", dark: "auto" };
const TITLES: Record<Theme, string> = { auto: "Theme: system", light: "Theme: light", dark: "Theme: dark" };

export function listenToTheme(viewers: readonly CleaveViewer[]): void {
  const button = byId("theme");
  let theme = (localStorage.getItem(KEPT_AS) ?? "auto") as Theme;
  const apply = () => {
    document.documentElement.dataset["theme"] = theme;
    for (const viewer of viewers) viewer.setAttribute("theme", theme);
    button.title = TITLES[theme];
    button.setAttribute("aria-label", TITLES[theme]);
  };
  button.addEventListener("click", () => {
    theme = NEXT[theme];
    localStorage.setItem(KEPT_AS, theme);
    apply();
  });
  apply();
}
