#include "page.hpp"

#include <fmt/format.h>

#include "assets.hpp"
#include "chapters.hpp"
#include "core/errors.hpp"
#include "core/provenance.hpp"
#include "html.hpp"
#include "viewer_data.hpp"

namespace valsalva::report {
namespace {

const char* const navigation =
    "<nav aria-label=\"Chapters\"><a href=\"#anatomy\">Anatomy</a><a href=\"#mesh\">Meshes</a>"
    "<a href=\"#device\">Device</a><a href=\"#deployment\">Deployment</a><a href=\"#beat\">Beat</a>"
    "<a href=\"#three-d\">3D</a><a href=\"#published\">Published figures</a><a href=\"#checks\">Checks</a>"
    "<a href=\"#accuracy\">Accuracy</a><a href=\"#cost\">Cost</a><a "
    "href=\"#provenance\">Provenance</a></nav>\n";

/// Inside <script>, "</" would end the element.
std::string script_safe(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3)
    text.replace(at, 2, "<\\/");
  return text;
}

std::string viewer_section(const RunData& run, const PageOptions& options) {
  std::string json, problem;
  try {
    json = viewer_json(run, options.viewer_frames);
  } catch (const Error& error) {
    problem = error.what();
  }
  std::string out = "<section id=\"three-d\"><h2>In three dimensions</h2>\n";
  if (!problem.empty()) return out + paragraph("No interactive view: " + problem, "problem") + "</section>\n";
  if (json == "{}")
    return out + paragraph("No state of this run has a body to show.", "absent") + "</section>\n";
  out +=
      "<div id=\"viewer\">Needs JavaScript and WebGL; the pictures of this page show the same "
      "states.</div>\n";
  out += "<script type=\"application/json\" id=\"scene\">" + script_safe(json) + "</script>\n</section>\n";
  return out;
}

}  // namespace

std::string page_begin(const std::string& title, const std::string& description) {
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
         "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"description\" content=\"" +
         escape(description) + "\">\n<title>" + escape(title) + "</title>\n<style>" + assets::style_css() +
         "</style>\n"
         "<script>window.addEventListener('error', function (e) { var r = document.documentElement; "
         "r.setAttribute('data-script-errors', (r.getAttribute('data-script-errors') || '') + e.message + '; "
         "'); });"
         "</script>\n</head><body>\n";
}

std::string page_end() {
  return "</body></html>\n";
}

std::string page(const RunData& run, const PageOptions& options) {
  std::string out = page_begin("Valsalva: " + run.case_name, "Report of the case " + run.case_name);
  out += "<header><h1>" + escape(run.case_name) + "</h1>\n";
  if (!options.title.empty()) out += paragraph(options.title, "lead");
  out += chain_list(run) + navigation + "</header>\n<main>\n" + overview_tiles(run);
  out += anatomy_chapter(run, options) + mesh_chapter(run, options) + device_chapter(run, options) +
         deployment_chapter(run, options) + beat_chapter(run, options);
  const std::string viewer = viewer_section(run, options);
  out += viewer;
  out += published_chapter(run) + checks_chapter(run) + accuracy_chapter(run) + cost_chapter(run) +
         provenance_chapter(run);
  out += "</main>\n<footer>" +
         paragraph("Written by valsalva-report " + version() +
                   ". Pictures, curves and numbers are made from the files of this run alone.");
  const bool interactive = viewer.find("id=\"scene\"") != std::string::npos;
  if (interactive)
    out += details("Software inside this page", "<pre>" + escape(assets::three_licence()) + "</pre>");
  out += "</footer>\n<script>" + assets::page_js() + "</script>\n";
  if (interactive)
    out += "<script>" + assets::three_js() + "</script>\n<script>" + assets::viewer_js() + "</script>\n";
  return out + page_end();
}

}  // namespace valsalva::report
