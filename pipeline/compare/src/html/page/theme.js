// The theme is that of the system until the button is pressed.

const systemIsDark = matchMedia("(prefers-color-scheme: dark)");
let chosenTheme = null;

function isDark() {
  return chosenTheme === null ? systemIsDark.matches : chosenTheme === "dark";
}

function showTheme() {
  if (chosenTheme) document.documentElement.style.colorScheme = chosenTheme;
  byId("theme").textContent = isDark() ? "Light" : "Dark";
}

function toggleTheme() {
  chosenTheme = isDark() ? "light" : "dark";
  showTheme();
}

byId("theme").addEventListener("click", toggleTheme);
systemIsDark.addEventListener("change", showTheme);
showTheme();
