// Before the page is drawn: the theme that was chosen here, else that of the system.

(() => {
  const system = matchMedia("(prefers-color-scheme: dark)");
  const chosen = () => sessionStorage.getItem("theme");
  const show = () => {
    document.documentElement.dataset.theme = chosen() || (system.matches ? "dark" : "light");
  };
  show();
  system.addEventListener("change", show);
  document.addEventListener("DOMContentLoaded", () => {
    const button = document.getElementById("theme");
    const name = () => { button.textContent = document.documentElement.dataset.theme === "dark" ? "Light" : "Dark"; };
    name();
    system.addEventListener("change", name);
    button.addEventListener("click", () => {
      sessionStorage.setItem("theme", document.documentElement.dataset.theme === "dark" ? "light" : "dark");
      show();
      name();
    });
  });
})();
