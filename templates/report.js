// What a linked section needs, and paper: they are open.
const reveal = () => {
  const at = document.getElementById(location.hash.slice(1));
  const fold = at && at.closest("details");
  if (fold && !fold.open) { fold.open = true; at.scrollIntoView(); }
};
addEventListener("hashchange", reveal);
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach(fold => { fold.open = true; }));
reveal();
document.documentElement.classList.add("live");
